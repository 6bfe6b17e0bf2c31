# SPDX-License-Identifier: Apache-2.0
"""Each condition of a good demo, met and not met."""

from __future__ import annotations

from typing import Any

import pytest

from safety_island.cli.demo.events import DemoState
from safety_island.cli.demo.judge import conditions
from safety_island.cli.demo.machine_load import OtherWork
from tests.cli.demo.samples import ISLAND_SUMMARY, VEHICLE_SUMMARY


def judge(
    vehicle: dict[str, Any] | None = None, island: dict[str, Any] | None = None
) -> dict[str, tuple[bool | None, str]]:
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


def test_a_tick_missed_on_a_busy_machine_is_told_as_such() -> None:
    state = DemoState(
        vehicle_summary=VEHICLE_SUMMARY,
        island_summary=ISLAND_SUMMARY | {"missed_ticks": 2, "max_lateness_s": 0.31},
    )
    busy = conditions(state, others=OtherWork(1.6, 2))[-1]
    assert (busy.verdict, busy.holds) == ("BUSY", False)
    assert "400 ticks, 2 missed" in busy.text
    assert "the machine was busy: other programs used 1.6 of 2 cores" in busy.text
    assert "a tick was woken up to 310 ms late; end what keeps it busy" in busy.text
    for others in (OtherWork(0.1, 2), None):
        plain = conditions(state, others=others)[-1]
        assert (plain.verdict, plain.holds) == ("FAILED", False)
        assert "busy" not in plain.text


def test_a_busy_machine_that_missed_nothing_is_no_matter() -> None:
    state = DemoState(vehicle_summary=VEHICLE_SUMMARY, island_summary=ISLAND_SUMMARY)
    last = conditions(state, others=OtherWork(2.0, 2))[-1]
    assert (last.verdict, last.holds) == ("ok", True)


def test_what_a_disturbed_drive_did_not_keep_is_not_judged() -> None:
    state = DemoState(
        vehicle_summary=VEHICLE_SUMMARY | {"on_course": False},
        island_summary=ISLAND_SUMMARY,
        was_acted_on=True,
    )
    found = {one.name: one for one in conditions(state)}
    assert (found["on_course"].verdict, found["on_course"].holds) == ("-", None)
    assert found["on_course"].text.endswith("not judged: keys disturbed the drive")
    assert found["reached_speed"].holds


def test_a_drive_that_a_busy_machine_interrupted_is_told_as_such() -> None:
    late = {"silences": 2, "stopped_in_place": False, "stop_errors": [0.8]}
    state = DemoState(
        vehicle_summary=VEHICLE_SUMMARY | late, island_summary=ISLAND_SUMMARY | {"missed_ticks": 1}
    )
    found = {one.name: one for one in conditions(state, others=OtherWork(1.6, 2))}
    stop, ticks = found["stopped_in_place"], found["no_missed_ticks"]
    assert (stop.verdict, stop.holds, ticks.verdict) == ("BUSY", False, "BUSY")
    assert "commands stopped coming 2 times\nthe machine was busy" in stop.text
    assert "the machine was busy" not in ticks.text, "it is said once"
    assert found["on_course"].verdict == "ok"
    quiet = {one.name: one for one in conditions(state, others=OtherWork(0.1, 2))}
    assert quiet["stopped_in_place"].verdict == "FAILED"


def test_a_drive_that_went_wrong_by_itself_is_not_blamed_on_the_machine() -> None:
    state = DemoState(
        vehicle_summary=VEHICLE_SUMMARY | {"silences": 0, "on_course": False},
        island_summary=ISLAND_SUMMARY,
    )
    first = conditions(state, others=OtherWork(1.6, 2))[0]
    assert (first.verdict, first.holds) == ("FAILED", False)
    assert "busy" not in first.text
