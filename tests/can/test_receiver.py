# SPDX-License-Identifier: Apache-2.0
"""The receiver's side: complete triples with an advancing sequence, and when they are lost."""

from __future__ import annotations

from collections.abc import Iterable

import pytest

from safety_island.can.decoder import Decoded, Fault
from safety_island.can.receiver import CommandReceiver, Link, Verdict
from safety_island.can.triple import Progress, TripleAssembler
from safety_island.platform.interfaces import CanFrame
from tests.can.rig import triple

PERIOD_S = 0.15
FRAME_S = 0.0002


class Bench:
    """A receiver, and a sender whose frames it hears one by one."""

    def __init__(self) -> None:
        self.receiver = CommandReceiver(PERIOD_S)
        self.now_s = 100.0

    def hear(self, frames: Iterable[CanFrame]) -> list[Verdict | Fault | Progress]:
        found = []
        for frame in frames:
            found.append(self.receiver.feed(frame, self.now_s))
            self.now_s += FRAME_S
        return found

    def period(self, count: int = 1) -> None:
        self.now_s += count * PERIOD_S - 3 * FRAME_S

    def command(self, sequence: int, stamp_ns: int = 0) -> Verdict | Fault | Progress:
        """Send one command, and wait for the next period; return what it led to."""
        found = self.hear(triple(sequence, stamp_ns))[-1]
        self.period()
        return found

    def start(self, sequence: int = 41) -> None:
        assert self.command(sequence - 1) is Verdict.FIRST
        assert self.command(sequence) is Verdict.ACCEPTED


@pytest.fixture
def bench() -> Bench:
    return Bench()


def test_a_command_is_accepted_when_its_triple_is_complete(bench: Bench) -> None:
    bench.start()
    frames = triple(42)
    assert bench.hear(frames) == [Progress.PENDING, Progress.PENDING, Verdict.ACCEPTED]
    assert bench.receiver.command is not None
    assert bench.receiver.command.sequence == 42
    assert bench.receiver.command.command.steering_tire_angle == 0.125


def test_the_first_triple_is_only_what_the_next_must_advance_from(bench: Bench) -> None:
    assert bench.receiver.link(bench.now_s) is Link.WAITING
    assert bench.command(7) is Verdict.FIRST
    assert bench.receiver.command is None
    assert bench.receiver.link(bench.now_s) is Link.WAITING
    assert bench.command(8) is Verdict.ACCEPTED
    assert bench.receiver.link(bench.now_s) is Link.ALIVE


@pytest.mark.parametrize("missing", [0, 1, 2])
def test_a_torn_triple_is_not_a_command(bench: Bench, missing: int) -> None:
    bench.start(41)
    frames = list(triple(42))
    del frames[missing]
    bench.hear(frames)
    bench.period()
    assert bench.receiver.command is not None
    assert bench.receiver.command.sequence == 41
    assert bench.command(43) is Verdict.ACCEPTED
    assert bench.receiver.counts[Progress.TORN] == 1


@pytest.mark.parametrize("order", [(1, 0, 2), (0, 2, 1), (2, 1, 0), (1, 2, 0), (2, 0, 1)])
def test_frames_in_another_order_are_not_a_command(bench: Bench, order: tuple[int, ...]) -> None:
    bench.start(41)
    frames = triple(42)
    assert Verdict.ACCEPTED not in bench.hear(frames[index] for index in order)


def test_frames_of_two_commands_are_never_mixed(bench: Bench) -> None:
    """Lost: 0x101 and 0x102 of one command and 0x100 of the next."""
    bench.start(41)
    bench.hear(triple(42, angle=0.4)[:1])
    bench.now_s += PERIOD_S - FRAME_S
    assert bench.hear(triple(43, angle=-0.4)[1:]) == [Progress.SPREAD, Progress.STRAY]


@pytest.mark.parametrize("advance", [1, 2, 3, 4])
def test_lost_commands_are_no_reason_to_refuse_the_next(bench: Bench, advance: int) -> None:
    bench.start(41)
    assert bench.command(41 + advance) is Verdict.ACCEPTED


@pytest.mark.parametrize("sequence", [41, 40, 0, 46, 41 + 2**15, 40 + 2**16])
def test_a_sequence_that_does_not_advance_is_refused(bench: Bench, sequence: int) -> None:
    bench.start(41)
    assert bench.command(sequence) is Verdict.NOT_ADVANCED
    assert bench.command(42) is Verdict.ACCEPTED


def test_three_periods_without_a_command_are_a_loss(bench: Bench) -> None:
    bench.start()
    accepted_s = bench.now_s - PERIOD_S + 2 * FRAME_S
    assert bench.receiver.link(accepted_s + 3 * PERIOD_S - 1e-6) is Link.ALIVE
    assert bench.receiver.link(accepted_s + 3 * PERIOD_S + 1e-6) is Link.LOST


def test_after_a_loss_two_triples_in_a_row_are_needed(bench: Bench) -> None:
    """So a triple that a queue held back while the bus was off is never acted on."""
    bench.start(41)
    bench.period(10)
    assert bench.command(42) is Verdict.FIRST
    assert bench.receiver.link(bench.now_s) is Link.LOST
    bench.period(10)
    assert bench.command(60) is Verdict.FIRST
    assert bench.command(61) is Verdict.ACCEPTED
    assert bench.receiver.link(bench.now_s) is Link.ALIVE


def test_a_sender_that_starts_anew_is_accepted_after_the_loss(bench: Bench) -> None:
    bench.start(1000)
    found = [bench.command(sequence) for sequence in range(8)]
    assert found[0] is Verdict.NOT_ADVANCED
    assert found[-1] is Verdict.ACCEPTED


def test_other_frames_and_faulty_ones_are_counted(bench: Bench) -> None:
    bench.start(41)
    assert bench.hear([CanFrame(0x123, b"")]) == [Progress.UNRELATED]
    frames = triple(42)
    broken = frames[2]._replace(data=bytes(8))
    assert bench.hear([*frames[:2], broken])[-1] is Fault.NOT_VALID
    assert bench.receiver.counts[Fault.NOT_VALID] == 1
    assert bench.command(42) is Verdict.ACCEPTED


def test_joining_in_the_middle_of_a_command_is_no_torn_triple() -> None:
    assembler = TripleAssembler(0.1)
    frames = triple()
    assert [assembler.feed(frame, 0.0) for frame in frames[1:]] == [Progress.STRAY] * 2
    assert isinstance([assembler.feed(frame, 0.1) for frame in frames][-1], Decoded)


def test_frames_may_lie_apart_as_far_as_the_window() -> None:
    assembler = TripleAssembler(0.1)
    frames = triple()
    assembler.feed(frames[0], 1.0)
    assembler.feed(frames[1], 1.05)
    assert isinstance(assembler.feed(frames[2], 1.09), Decoded)
    assembler.feed(frames[0], 2.0)
    assert assembler.feed(frames[1], 1.9) is Progress.SPREAD
