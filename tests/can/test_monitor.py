# SPDX-License-Identifier: Apache-2.0
"""What the monitor finds in a stream of frames, worked out by hand."""

from __future__ import annotations

from collections.abc import Iterable

import pytest

from safety_island.can.candump import LogEntry
from safety_island.can.decoder import Fault
from safety_island.can.monitor import RECENT, BusMonitor, Seen
from safety_island.can.receiver import Link
from safety_island.can.triple import Progress
from safety_island.platform.interfaces import CanFrame
from tests.can.rig import triple

PERIOD_S = 0.15


def hear(monitor: BusMonitor, time_s: float, frames: Iterable[CanFrame]) -> list[Seen]:
    """Feed frames 1 ms apart; return the commands that they completed."""
    found = [monitor.feed(LogEntry(time_s + i / 1000, frame)) for i, frame in enumerate(frames)]
    return [seen for seen in found if seen]


def drive(monitor: BusMonitor, sequences: Iterable[int], start_s: float = 10.0) -> None:
    for index, sequence in enumerate(sequences):
        hear(monitor, start_s + index * PERIOD_S, triple(sequence))


def test_nothing_yet() -> None:
    monitor = BusMonitor(PERIOD_S)
    assert monitor.commands.rate_hz is None
    assert monitor.commands.age_s(1.0) is None
    assert monitor.latest is None


def test_counts_rates_gaps_and_ages() -> None:
    monitor = BusMonitor(PERIOD_S)
    drive(monitor, range(11))
    assert {i: a.count for i, a in monitor.frames.items()} == {0x100: 11, 0x101: 11, 0x102: 11}
    assert monitor.commands.count == 11
    assert monitor.commands.rate_hz == pytest.approx(1 / PERIOD_S)
    assert monitor.commands.longest_gap_s == pytest.approx(PERIOD_S)
    assert monitor.frames[0x100].age_s(12.0) == pytest.approx(0.5)
    assert monitor.commands.age_s(12.0) == pytest.approx(0.498)
    assert monitor.losses.over == 0


def test_a_live_rate_follows_the_newest_arrivals() -> None:
    monitor = BusMonitor(PERIOD_S, RECENT)
    for index in range(100):
        hear(monitor, float(index), triple(index))
    for index in range(RECENT):
        hear(monitor, 200.0 + index / 10, triple(100 + index))
    assert monitor.commands.rate_hz == pytest.approx(10.0)
    assert monitor.commands.count == 100 + RECENT


@pytest.mark.parametrize(
    ("sequences", "expected"),
    [
        ([5, 6, 7], (0, 0, 0, 0)),
        ([65534, 65535, 0, 1], (0, 0, 0, 0)),
        ([1, 2, 5, 6, 10], (2, 5, 0, 0)),
        ([65535, 2], (1, 2, 0, 0)),
        ([1, 1, 1, 2], (0, 0, 2, 0)),
        ([100, 3, 4], (0, 0, 0, 1)),
        ([0, 32767], (1, 32766, 0, 0)),
        ([0, 32768], (0, 0, 0, 1)),
    ],
)
def test_sequence(sequences: list[int], expected: tuple[int, ...]) -> None:
    monitor = BusMonitor(PERIOD_S)
    drive(monitor, sequences)
    s = monitor.sequence
    assert (s.gaps, s.missing, s.repeated, s.backward) == expected


def test_incomplete_commands_are_counted_by_kind() -> None:
    monitor = BusMonitor(PERIOD_S)
    hear(monitor, 1.0, triple(1)[:2])
    hear(monitor, 2.0, triple(2))
    broken = triple(3)[2]._replace(data=bytes(8))
    hear(monitor, 3.0, [*triple(3)[:2], broken])
    hear(monitor, 4.0, triple(4)[:1])
    hear(monitor, 4.2, triple(4)[1:2])
    assert monitor.faults == {Progress.TORN: 1, Fault.NOT_VALID: 1, Progress.SPREAD: 1}
    assert monitor.commands.count == 1


def test_three_periods_without_a_command_are_a_loss() -> None:
    monitor = BusMonitor(PERIOD_S)
    for number, time_s in enumerate((1.0, 1.15, 1.15 + 3.01 * PERIOD_S, 3.0)):
        hear(monitor, time_s, triple(number))
    assert monitor.losses.over == 2


def test_other_frames_and_error_frames() -> None:
    monitor = BusMonitor(PERIOD_S)
    hear(monitor, 1.0, [CanFrame(0x555, b"")])
    monitor.feed(LogEntry(1.0, None))
    monitor.feed(LogEntry(1.0, None, is_error=True))
    assert (monitor.other_frames, monitor.error_frames) == (2, 1)
    hear(monitor, 2.0, [triple()[0], CanFrame(0x555, b""), *triple()[1:]])
    assert monitor.commands.count == 1


@pytest.mark.parametrize(
    ("time_s", "lag_ms"),
    [(12.345, 0), (12.4, 55), (12.3, -45), (2**32 / 1000 + 12.4, 55)],
)
def test_lag_between_stamp_and_arrival(time_s: float, lag_ms: int) -> None:
    monitor = BusMonitor(PERIOD_S)
    (seen,) = hear(monitor, time_s - 0.002, triple())
    assert seen.lag_ms == pytest.approx(lag_ms, abs=1)


LIMIT_S = 3 * PERIOD_S
END_S = 10.0 + 9 * PERIOD_S + 0.002
"""When the last of ten commands was complete."""


def test_a_loss_that_lasts_is_a_loss() -> None:
    monitor = BusMonitor(PERIOD_S)
    drive(monitor, range(10))
    assert monitor.losses.count(END_S + LIMIT_S - 0.001) == 0
    assert monitor.alarm(END_S + LIMIT_S - 0.001) == ""
    for age_s in (LIMIT_S + 0.001, 8.0, 3600.0):
        assert monitor.losses.count(END_S + age_s) == 1
        assert monitor.losses.link(END_S + age_s) is Link.LOST
    expected = "LOST: no new command for 8.000 s, and none of its frames comes"
    assert monitor.alarm(END_S + 8.0) == expected


def test_a_loss_that_ended_is_counted_once() -> None:
    monitor = BusMonitor(PERIOD_S)
    drive(monitor, range(10))
    assert monitor.losses.count(END_S + 8.0) == 1
    drive(monitor, range(10, 20), start_s=END_S + 8.0)
    assert monitor.losses.count(END_S + 8.0 + 9 * PERIOD_S) == 1
    assert monitor.alarm(END_S + 8.0 + 9 * PERIOD_S) == ""


@pytest.mark.parametrize("missing", [0, 1, 2])
def test_a_frame_that_stays_away_is_a_loss_and_is_named(missing: int) -> None:
    monitor = BusMonitor(PERIOD_S)
    drive(monitor, range(10))
    for number in range(10, 20):
        rest = [frame for i, frame in enumerate(triple(number)) if i != missing]
        hear(monitor, 10.0 + number * PERIOD_S, rest)
    now_s = 10.0 + 19 * PERIOD_S + 0.002
    assert monitor.losses.count(now_s) == 1
    name = f"0x{0x100 + missing:03X}"
    assert monitor.alarm(now_s) == f"LOST: no new command for 1.500 s, {name} missing"


def test_a_sequence_that_stands_still_is_a_loss() -> None:
    monitor = BusMonitor(PERIOD_S)
    drive(monitor, [0, 1, 2, 3, 4, *[4] * 10])
    now_s = 10.0 + 14 * PERIOD_S + 0.002
    assert monitor.commands.count == 15
    assert monitor.losses.count(now_s) == 1
    assert monitor.alarm(now_s).endswith("the sequence does not advance from 4")


def test_frames_that_make_no_command_are_a_loss() -> None:
    monitor = BusMonitor(PERIOD_S)
    for number in range(10):
        for index, frame in enumerate(triple(number)):
            monitor.feed(LogEntry(10.0 + (number + index / 3) * PERIOD_S, frame))
    assert monitor.commands.count == 0
    assert monitor.alarm(11.45).endswith("its frames do not make a command")


def test_a_first_frame_that_never_comes_is_a_loss() -> None:
    monitor = BusMonitor(None, RECENT, started_s=100.0)
    assert monitor.losses.link(100.4) is Link.WAITING
    expected = "LOST: no command has come for 8.000 s, and none of its frames comes"
    assert monitor.alarm(108.0) == expected
    assert monitor.losses.count(108.0) == 1
    for index, frame in enumerate(triple(1)):
        monitor.feed(LogEntry(1e9 + index / 1000, frame), 109.0)
    assert monitor.losses.link(109.1) is Link.ALIVE


@pytest.mark.parametrize("period_s", [0.03, 0.15, 0.5])
def test_the_period_is_that_of_the_frames(period_s: float) -> None:
    monitor = BusMonitor()
    for number in range(10):
        hear(monitor, 10.0 + number * period_s, triple(number))
    assert monitor.losses.period_s == pytest.approx(period_s)
    end_s = 10.0 + 9 * period_s + 0.002
    assert monitor.losses.count(end_s + 2.9 * period_s) == 0
    assert monitor.losses.count(end_s + 3.1 * period_s) == 1


@pytest.mark.parametrize(("jump_s", "stall_s"), [(3600.0, PERIOD_S), (-3600.0, PERIOD_S)])
def test_a_clock_that_is_set_is_no_loss(jump_s: float, stall_s: float) -> None:
    monitor = BusMonitor(PERIOD_S, RECENT, started_s=0.0)
    for number in range(10):
        for index, frame in enumerate(triple(number)):
            heard_s = number * stall_s + index / 1000
            stamp_s = 1e9 + heard_s + (jump_s if number >= 5 else 0.0)
            monitor.feed(LogEntry(stamp_s, frame), heard_s)
    assert monitor.losses.count(9 * stall_s) == 0
    assert monitor.losses.count(9 * stall_s + 1.0) == 1


def test_a_monitor_that_stood_still_itself_saw_no_loss() -> None:
    monitor = BusMonitor(PERIOD_S, RECENT, started_s=0.0)
    for number in range(20):
        for frame in triple(number):
            stamp_s = number * PERIOD_S
            monitor.feed(LogEntry(stamp_s, frame), stamp_s if number < 5 else 5.0)
    assert monitor.losses.count(5.0) == 0
