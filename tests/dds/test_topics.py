# SPDX-License-Identifier: Apache-2.0
"""The one table of topics, as the contract (section 2) and the fault catalogue have it."""

from __future__ import annotations

import pytest

from safety_island.dds import topics
from safety_island.dds.qos import DEFAULT, INPUT_DEPTH, LATCHED
from safety_island.dds.topics import ARM, BRIDGED, EVERY_TICK, INPUTS, OUTPUTS, OWN, STATUS, TOPICS
from safety_island.messages import registry
from safety_island.params import load_set
from safety_island.params.schema import values_of

DEBUG = "/control/trajectory_follower/{}/debug/processing_time_ms"
CONTRACT = {
    "/vehicle/status/steering_status": "autoware_vehicle_msgs/msg/SteeringReport",
    "/planning/scenario_planning/trajectory": "autoware_planning_msgs/msg/Trajectory",
    "/localization/kinematic_state": "nav_msgs/msg/Odometry",
    "/localization/acceleration": "geometry_msgs/msg/AccelWithCovarianceStamped",
    "/system/operation_mode/state": "autoware_adapi_v1_msgs/msg/OperationModeState",
    "/control/trajectory_follower/control_cmd": "autoware_control_msgs/msg/Control",
    DEBUG.format("lateral"): "tier4_debug_msgs/msg/Float64Stamped",
    DEBUG.format("longitudinal"): "tier4_debug_msgs/msg/Float64Stamped",
}


def test_names_and_types_are_those_of_the_contract() -> None:
    assert {entry.name: entry.type_name for entry in TOPICS} == CONTRACT
    assert all(registry.known(entry.type_name) for entry in TOPICS)


def test_five_inputs_three_outputs_six_bridged() -> None:
    assert (len(INPUTS), len(OUTPUTS), len(BRIDGED)) == (5, 3, 6)
    assert [entry.bridged for entry in INPUTS] == [(1, 2)] * 5
    assert [entry.bridged for entry in OUTPUTS] == [(2, 1), None, None]


def test_ages() -> None:
    values = values_of(load_set("default"))
    limits = {entry.key: values.get(entry.age_limit) for entry in INPUTS}
    assert limits == {
        "steering": 0.5,
        "odometry": 0.5,
        "acceleration": 0.5,
        "trajectory": 0.9,
        "operation_mode": None,
    }
    assert values["gate.age_warning"] == 0.28


def test_states_that_are_sent_on_change_are_latched() -> None:
    latched = [entry.key for entry in TOPICS if entry.qos == LATCHED]
    assert latched == ["operation_mode", "control"]
    assert all(entry.qos == DEFAULT for entry in TOPICS if entry.key not in latched)
    assert all(entry.subscription_qos.depth == INPUT_DEPTH for entry in INPUTS)


def test_the_islands_own_topics_stay_on_its_domain() -> None:
    assert OWN == (STATUS, ARM)
    assert not set(OWN) & set(TOPICS)
    assert all(entry.bridged is None and entry.qos == DEFAULT for entry in OWN)
    assert all(registry.known(entry.type_name) for entry in OWN)
    assert (STATUS.rate_hz, ARM.rate_hz) == (EVERY_TICK, None)


def test_an_entry_is_found_by_its_key() -> None:
    assert topics.topic("odometry") is topics.ODOMETRY
    assert topics.topic("status") is STATUS
    with pytest.raises(KeyError):
        topics.topic("camera")


def test_debug_topics_change_their_package_with_041_and_are_not_bridged() -> None:
    old, new = (topics.of_release(topics.DEBUG, release) for release in ("0.40", "0.41"))
    assert not set(topics.DEBUG) & {*TOPICS, *OWN}
    assert all(entry.bridged is None for entry in new)
    assert all(registry.known(entry.type_name) for entry in (*old, *new))
    assert [entry.name for entry in old] == [entry.name for entry in new]
    packages = [
        {entry.type_name.split("/")[0] for entry in entries if "debug_msgs" in entry.type_name}
        for entries in (old, new)
    ]
    assert packages == [{"tier4_debug_msgs"}, {"autoware_internal_debug_msgs"}]
