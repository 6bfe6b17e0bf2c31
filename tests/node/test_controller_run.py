# SPDX-License-Identifier: Apache-2.0
"""The controller node on the platform's timer, in virtual time."""

from __future__ import annotations

import pytest

from safety_island.platform import LogConfig, LogLevel
from tests.faults.hands import fail_with
from tests.node.rig import ROWS, FakeFollower, Rig


def test_a_duration_is_so_many_periods(rig: Rig) -> None:
    rig.everything(ROWS)
    reports: list[int] = []
    rig.node.observers.append(lambda report: reports.append(report.number))
    rig.node.run(0.15, duration_s=1.5)
    assert reports == list(range(1, 11))
    assert rig.clock.monotonic_ns() == 1_001_500_000_000


def test_actions_between_the_ticks(rig: Rig) -> None:
    ages: list[float] = []
    rig.node.observers.append(lambda report: ages.append(round(report.ages_s[2], 9)))
    for time_ms in (100, 140, 350):
        rig.clock.call_at(1_000_000_000_000 + time_ms * 1_000_000, rig.steering)
    rig.node.run(0.15, duration_s=0.6)
    assert ages == [0.15, 0.3, 0.15, 0.3]  # as if received right after the tick before


def test_stop_ends_the_run_after_the_tick(rig: Rig) -> None:
    rig.node.observers.append(lambda report: rig.node.stop())
    rig.node.run(0.15)
    assert rig.node.report is not None and rig.node.report.number == 1


def test_an_observer_that_fails_stops_neither_the_run_nor_the_others(rig: Rig) -> None:
    seen: list[int] = []
    rig.node.observers.append(fail_with(ZeroDivisionError("on purpose")))
    rig.node.observers.append(lambda report: seen.append(report.number))
    rig.node.run(0.15, duration_s=0.6)
    assert seen == [1, 2, 3, 4]
    assert any("an observer failed: ZeroDivisionError: on purpose" in line for line in rig.lines)


def test_without_memory_a_run_ends(rig: Rig) -> None:
    rig.node.observers.append(fail_with(MemoryError()))
    with pytest.raises(MemoryError):
        rig.node.run(0.15, duration_s=0.6)


def test_without_a_reader_of_what_it_prints_a_run_goes_on(rig: Rig) -> None:
    rig.node.observers.append(fail_with(BrokenPipeError()))
    rig.node.run(0.15, duration_s=0.6)
    assert rig.node.report is not None and rig.node.report.number == 4


def test_missed_ticks_are_told(rig: Rig, follower: FakeFollower) -> None:
    rig.everything(ROWS)
    seen: list[tuple[int, float]] = []

    def stall_once(report: object) -> None:
        assert rig.node.report is not None
        seen.append((rig.node.report.skipped, round(rig.node.report.lateness_s, 9)))
        if len(seen) == 1:
            rig.clock.advance_to_ns(rig.clock.monotonic_ns() + 470_000_000)

    rig.node.observers.append(stall_once)
    rig.node.run(0.15, duration_s=0.75)
    assert seen == [(0, 0.0), (2, 0.02), (0, 0.0)]
    assert any("2 ticks were missed" in line for line in rig.lines)


def test_it_says_that_it_is_live(rig: Rig) -> None:
    rig.node.run(0.03, duration_s=0.0)
    assert "safety_island is live, with a period of 30 ms" in rig.lines[0]


def test_log_level_none_says_nothing(follower: FakeFollower) -> None:
    rig = Rig(follower, log=LogConfig(level=LogLevel.NONE))
    rig.node.run(0.15, duration_s=1.0)
    assert rig.lines == []


def test_the_same_inputs_give_the_same_bytes() -> None:
    def drive() -> list[bytes]:
        rig = Rig(FakeFollower())
        sent: list[bytes] = []
        rig.node.observers.append(lambda report: sent.append(rig.commands.take_newest().data))
        rig.node.observers.append(lambda report: rig.everything(ROWS))
        rig.everything(ROWS)
        rig.node.run(0.15, duration_s=3.0)
        return sent

    assert drive() == drive()
