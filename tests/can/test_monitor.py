"""What the monitor finds in a stream of frames, worked out by hand."""

from __future__ import annotations

from collections.abc import Iterable

import pytest

from safety_island.can.candump import LogEntry
from safety_island.can.decoder import Fault
from safety_island.can.monitor import RECENT, BusMonitor, Seen
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
    assert monitor.losses == 0


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
    for time_s in (1.0, 1.15, 1.15 + 3.01 * PERIOD_S, 3.0):
        hear(monitor, time_s, triple())
    assert monitor.losses == 2


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
