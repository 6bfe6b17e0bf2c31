# SPDX-License-Identifier: Apache-2.0
"""The number of a parameter set tells it from every other one."""

from __future__ import annotations

from safety_island.params import SETS, from_mapping, load_set, parameters_hash


def test_the_same_values_have_the_same_number_wherever_they_come_from() -> None:
    for name in SETS:
        assert parameters_hash(load_set(name)) == parameters_hash(load_set(name))
    period = load_set("default").node.ctrl_period
    assert parameters_hash(from_mapping({"ctrl_period": period})) == parameters_hash(
        from_mapping({})
    )


def test_any_other_value_in_any_group_is_another_number() -> None:
    changes: list[dict[str, object]] = [
        {},
        {"ctrl_period": 0.05},
        {"wheel_base": 2.5},
        {"mpc_weight_lat_error": 1.0 + 2.0**-52},
        {"kp": 1.25},
        {"gate.age_limit.odometry": 0.75},
        {"life_cycle.discovery_time": 1.5},
    ]
    numbers = {parameters_hash(from_mapping(change)) for change in changes}
    assert len(numbers) == len(changes)
    assert all(0 <= number < 2**64 for number in numbers)
