"""Each condition of a good demo, met and not met."""

from __future__ import annotations

from typing import Any

import pytest

from safety_island.cli.demo.events import DemoState
from safety_island.cli.demo.judge import conditions
from tests.cli.demo.samples import ISLAND_SUMMARY, VEHICLE_SUMMARY


def judge(
    vehicle: dict[str, Any] | None = None, island: dict[str, Any] | None = None
) -> dict[str, tuple[bool, str]]:
    state = DemoState(
        vehicle_summary=VEHICLE_SUMMARY | (vehicle or {}),
        island_summary=ISLAND_SUMMARY | (island or {}),
    )
    return {condition.name: (condition.holds, condition.text) for condition in conditions(state)}


def test_all_is_well() -> None:
    found = judge()
    assert list(found) == ["on_course", "reached_speed", "stopped_in_place", "no_missed_ticks"]
    assert all(holds for holds, _ in found.values())
    assert "0.042 m" in found["on_course"][1]
    assert "7.98 m/s" in found["reached_speed"][1]
    assert "stopped once, at most 0.12 m" in found["stopped_in_place"][1]
    assert "400 ticks, none missed" in found["no_missed_ticks"][1]


@pytest.mark.parametrize("name", ["on_course", "reached_speed", "stopped_in_place"])
def test_vehicle_failed(name: str) -> None:
    found = judge({name: False})
    assert [other for other, (holds, _) in found.items() if not holds] == [name]


def test_no_stop_was_made() -> None:
    holds, text = judge({"stop_errors": [], "stopped_in_place": False})["stopped_in_place"]
    assert (holds, text) == (False, "no stop was reached in this time")


def test_demo_that_a_person_ended_needs_no_stop() -> None:
    nothing = VEHICLE_SUMMARY | {"stop_errors": [], "stopped_in_place": False}
    state = DemoState(vehicle_summary=nothing, island_summary=ISLAND_SUMMARY)
    assert all(condition.holds for condition in conditions(state, cut_short=True))
    bad = nothing | {"stop_errors": [0.9]}
    state = DemoState(vehicle_summary=bad, island_summary=ISLAND_SUMMARY)
    assert not all(condition.holds for condition in conditions(state, cut_short=True))


def test_ticks_were_missed() -> None:
    holds, text = judge(island={"missed_ticks": 2})["no_missed_ticks"]
    assert not holds
    assert "400 ticks, 2 missed" in text


def test_island_that_never_ticked_is_no_success() -> None:
    nothing = {"ticks": 0, "tick_times_s": {"median": None, "p99": None, "max": None}}
    assert not judge(island=nothing)["no_missed_ticks"][0]


def test_silent_processes_are_no_success() -> None:
    assert not any(condition.holds for condition in conditions(DemoState()))
    only_vehicle = DemoState(vehicle_summary=VEHICLE_SUMMARY)
    assert not conditions(only_vehicle)[-1].holds
