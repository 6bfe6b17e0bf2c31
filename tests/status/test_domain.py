# SPDX-License-Identifier: Apache-2.0
"""Why an input does not come, as discovery knows it: without DDS, and with real publishers."""

from __future__ import annotations

import json
import math
from typing import Any

import pytest

from safety_island.cli.main import main
from safety_island.dds.config import URI, DdsConfig
from safety_island.dds.discovery import RemoteEndpoint
from safety_island.dds.participant import Participant
from safety_island.dds.qos import Qos
from safety_island.dds.topics import STATUS
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.messages.status_fields import Status
from safety_island.node.inputs import INPUTS
from safety_island.status.domain import Domain
from safety_island.status.why import why
from tests.status.samples import (
    NOT_FINITE,
    ODOMETRY,
    OPERATION_MODE,
    STALE,
    TRAJECTORY,
    FakeIsland,
    sample,
)

WHERE = "domain 2, interface lo"
PLACES = range(len(INPUTS))
QOS_DIFFERENCES = (
    (Qos(reliability="best_effort"), "reliability is best_effort, requested is reliable"),
    (Qos(deadline_ns=2), "deadline_ns is 2, requested is 1"),
    (Qos(lease_ns=2), "lease_ns is 2, requested is 1"),
)


def missing(place: int, **changes: Any) -> Status:
    """An island that waits for an input of which nothing came."""
    row = {"age": math.inf, "received": 0, "accepted": 0} | changes
    state = {"state": State.INIT, "reason": Reason.WAITING_FOR_INPUT, "published": False}
    return sample({place: row}, **state, subject=place)


class Found:
    """What discovery found, by topic."""

    def __init__(self, publications: Any = None, subscriptions: Any = None) -> None:
        self._publications, self._subscriptions = publications or {}, subscriptions or {}

    def publications(self, topic: str) -> list[RemoteEndpoint]:
        return list(self._publications.get(topic, ()))

    def subscriptions(self, topic: str) -> list[RemoteEndpoint]:
        return list(self._subscriptions.get(topic, ()))


def endpoint(
    topic: str, type_name: str, qos: Qos, participant: bytes = b"p" * 16
) -> RemoteEndpoint:
    return RemoteEndpoint(b"\x01" * 16, participant, topic, type_name, qos)


def domain(place: int, qos: Qos | None = None, type_name: str = "", count: int = 1) -> Domain:
    """Publishers of an input; as the table says where nothing else is said."""
    entry = INPUTS[place].topic
    remote = endpoint(entry.name, type_name or entry.type_name, qos or entry.qos)
    return Domain(Found({entry.name: [remote] * count}), WHERE)


@pytest.mark.parametrize("place", PLACES)
def test_no_publisher_is_said_with_topic_domain_and_interface(place: int) -> None:
    told = why(missing(place), domain=Domain(Found(), WHERE))
    assert f"no publisher is on {INPUTS[place].topic.name} on domain 2, interface lo" in told
    action = "start its publisher or 'island bridge', on this domain and interface; 'island env' "
    assert told.endswith(f"{action}prints the settings that a program needs to be found.")


@pytest.mark.parametrize("place", PLACES)
def test_a_type_that_does_not_match_is_named(place: int) -> None:
    told = why(missing(place), domain=domain(place, type_name="std_msgs/msg/Header"))
    assert f"has type std_msgs/msg/Header, expected {INPUTS[place].topic.type_name}" in told
    assert "publish with the type and at least the QoS" in told


def test_a_qos_that_does_not_match_is_named() -> None:
    told = why(missing(ODOMETRY), domain=domain(ODOMETRY, Qos(reliability="best_effort")))
    assert "does not match: reliability is best_effort, requested is reliable" in told
    told = why(missing(OPERATION_MODE), domain=domain(OPERATION_MODE, Qos()))
    assert "durability is volatile, requested is transient_local" in told


@pytest.mark.parametrize(("offered", "words"), QOS_DIFFERENCES)
def test_what_the_island_requests_is_taken_from_the_island(offered: Qos, words: str) -> None:
    """Its own subscription counts where it is seen, not what the table says."""
    entry, island = INPUTS[ODOMETRY].topic, b"i" * 16
    strict = Qos(deadline_ns=1, lease_ns=1)
    found = Found(
        {
            STATUS.name: [endpoint(STATUS.name, STATUS.type_name, STATUS.qos, island)],
            entry.name: [endpoint(entry.name, entry.type_name, offered)],
        },
        {
            entry.name: [
                endpoint(entry.name, entry.type_name, Qos(reliability="best_effort")),
                endpoint(entry.name, entry.type_name, strict, island),
            ]
        },
    )
    assert words in why(missing(ODOMETRY), domain=Domain(found, WHERE))


@pytest.mark.parametrize("count", [1, 2])
def test_a_publisher_that_matches_and_sends_nothing(count: int) -> None:
    told = why(missing(TRAJECTORY), domain=domain(TRAJECTORY, count=count))
    assert "matches, but nothing comes from it" in told and "firewall" in told
    stale = sample({ODOMETRY: {"age": 0.7}}, **STALE)
    assert "but nothing new comes from it" in why(stale, domain=domain(ODOMETRY))


def test_an_input_that_was_lost_with_its_publisher() -> None:
    told = why(sample({ODOMETRY: {"age": 0.7}}, **STALE), domain=Domain(Found(), WHERE))
    assert "odometry is older than its limit (0.70 s, limit 0.50 s; no publisher is on" in told


def test_samples_that_are_refused_have_their_own_reason() -> None:
    told = why(sample({ODOMETRY: NOT_FINITE}, **STALE), domain=Domain(Found(), WHERE))
    assert "the last 3 samples were refused" in told and "no publisher" not in told


def test_the_publisher_of_the_operation_mode() -> None:
    gone = sample(reason=Reason.MODE_WRITER_GONE, state=State.READY, subject=255)
    assert "no publisher is on /system/operation_mode/state" in why(
        gone, domain=Domain(Found(), WHERE)
    )


def test_nothing_at_all_comes() -> None:
    cut = sample(state=State.SILENT, published=False, reason=Reason.PARTITION)
    assert f"no publisher of any input is on {WHERE}" in why(cut, domain=Domain(Found(), WHERE))
    assert "no publisher" not in why(cut, domain=domain(ODOMETRY))


@pytest.mark.parametrize("reason", [Reason.NO_TRAJECTORY, Reason.SECOND_PUBLISHER, Reason.LATCHED])
def test_discovery_has_no_part_in_other_reasons(reason: Reason) -> None:
    status = sample(state=State.SILENT, published=False, reason=reason, subject=ODOMETRY)
    assert why(status, domain=Domain(Found(), WHERE)) == why(status)


@pytest.mark.parametrize(
    ("type_name", "qos", "words"),
    [
        ("", Qos(reliability="best_effort"), "reliability is best_effort, requested is reliable"),
        ("std_msgs/msg/Header", Qos(), "has type std_msgs/msg/Header, expected nav_msgs"),
        ("", Qos(), "its publisher is on /localization/kinematic_state and matches"),
        (None, Qos(), "no publisher is on /localization/kinematic_state on domain"),
    ],
    ids=["qos", "type", "silent", "none"],
)
def test_real_publishers_over_dds(
    domain_id: int,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    type_name: str | None,
    qos: Qos,
    words: str,
) -> None:
    monkeypatch.delenv(URI, raising=False)
    entry = INPUTS[ODOMETRY].topic
    command = ["status", "--domain", str(domain_id), "--why", "--json", "--timeout", "20"]
    with (
        FakeIsland(domain_id, missing(ODOMETRY)),
        Participant(domain_id, DdsConfig(interface="lo"), "localization") as other,
    ):
        if type_name is not None:
            other.publisher(entry.name, type_name or entry.type_name, qos)
        assert main(command) == 1
    told = json.loads(capsys.readouterr().out)
    assert words in told["why"] and told["free"] is False
