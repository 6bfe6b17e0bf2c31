# SPDX-License-Identifier: Apache-2.0
"""Rows of the fault catalogue that concern CAN output; the number of each stands in its test."""

from __future__ import annotations

from itertools import pairwise

import pytest

from safety_island.can.bus import BusEvent, EventKind
from safety_island.can.command import Cause, Command
from safety_island.can.decoder import Decoded
from safety_island.can.link import DirectLink
from safety_island.can.mock import MockBus
from safety_island.can.output import CanOutput
from safety_island.can.receiver import CommandReceiver, Link, Verdict
from safety_island.can.spec import parse_spec
from safety_island.can.start import CanUnavailableError, start_output
from safety_island.can.triple import Progress
from safety_island.command.mode import OutputMode
from safety_island.platform.interfaces import CanFrame, CanResult
from tests.can.output_rig import PERIOD_S, OutputRig
from tests.can.rig import REFERENCE, FakeClock, LogLines, triple

DAYS_49_7_NS = 2**32 * 1_000_000


@pytest.fixture
def rig() -> OutputRig:
    return OutputRig()


def accepted(receiver: CommandReceiver, rig: OutputRig) -> int:
    """Let a receiver hear what is on the bus at this moment; return how much it accepts."""
    now_s = rig.clock.now_ns / 1e9
    found = [receiver.feed(frame, now_s) for frame in rig.bus.frames]
    rig.bus.frames.clear()
    return found.count(Verdict.ACCEPTED)


def test_row_36_sequence_and_timestamp_wrap(rig: OutputRig) -> None:
    rig.output._sequence = 65530
    rig.clock.now_ns = DAYS_49_7_NS - int(5.5 * PERIOD_S * 1e9)
    receiver = CommandReceiver(PERIOD_S)
    heard: list[Decoded] = []
    for _ in range(12):
        rig.tick()
        heard += rig.heard()
        accepted(receiver, rig)
    assert [c.sequence for c in heard] == [*range(65530, 65536), *range(6)]
    assert receiver.counts[Verdict.ACCEPTED] == 11
    stamps = [c.timestamp_ms for c in heard]
    assert stamps[5] > 2**32 - 200
    assert stamps[6] < 200
    assert {(b - a) % 2**32 for a, b in pairwise(stamps)} == {150}


@pytest.mark.parametrize("position", [0, 1, 2])
@pytest.mark.parametrize("fault", [r for r in CanResult if r is not CanResult.SENT])
def test_row_54_a_torn_triple_counts_as_failed(
    rig: OutputRig, position: int, fault: CanResult
) -> None:
    receiver = CommandReceiver(PERIOD_S)
    rig.tick(count=1)
    accepted(receiver, rig)
    rig.tick()
    assert accepted(receiver, rig) == 1
    rig.bus.faults.extend([CanResult.SENT] * position + [fault])
    assert rig.tick() == [Cause[fault.name]]
    assert accepted(receiver, rig) == 0
    assert rig.output.counters.frames == {(0x100 + position, Cause[fault.name]): 1}
    assert rig.tick() == [None]
    assert [c.sequence for c in rig.heard()] == [3]
    assert accepted(receiver, rig) == 1
    assert (rig.output.counters.sent, rig.output.counters.failed) == (3, 1)


def test_row_55_a_full_queue_drops_the_whole_command(rig: OutputRig) -> None:
    rig.bus.faults.extend([CanResult.QUEUE_FULL] * 2)
    causes = rig.tick(count=6)
    assert causes[:2] == [Cause.QUEUE_FULL] * 2
    assert causes[-1] is None
    assert rig.bus.discarded == 2  # before the second command, and with the reopening
    assert rig.output.counters.reopened == 1
    assert [c.sequence for c in rig.heard()] == list(range(causes.index(None), 6))


def test_row_56_a_bus_that_takes_too_long_gets_no_further_frame(rig: OutputRig) -> None:
    send = rig.bus.send

    def slow(frame: CanFrame, budget_s: float) -> CanResult:
        rig.clock.advance(budget_s)
        return send(frame, 0.0)

    rig.bus.send = slow  # type: ignore[method-assign]
    begun_ns = rig.clock.now_ns
    assert rig.output.send(REFERENCE, 0) is False
    assert rig.clock.now_ns - begun_ns <= PERIOD_S / 10 * 1e9
    assert [frame.arbitration_id for frame in rig.bus.frames] == [0x100]
    assert rig.output.counters.frames == {(0x101, Cause.TIMED_OUT): 1}


def test_row_57_bus_off_is_seen_before_a_frame_and_opened_again(rig: OutputRig) -> None:
    rig.tick()
    rig.bus.tell(BusEvent(EventKind.BUS_OFF))
    rig.bus.refusals = 2
    causes = rig.tick(count=12)
    assert causes[0] is Cause.BUS_OFF
    assert causes[-1] is None
    first = causes.index(None)
    assert [c.sequence for c in rig.heard()] == [0, *range(first + 1, 13)]
    assert rig.output.counters.events[EventKind.BUS_OFF] == 1
    assert rig.output.counters.reopened == 3
    assert "off the bus" in rig.log.lines[0]


@pytest.mark.parametrize("kind", [EventKind.ERROR_PASSIVE, EventKind.ERROR_WARNING])
def test_row_58_error_passive_warns_and_sends_on(rig: OutputRig, kind: EventKind) -> None:
    for _ in range(3):
        rig.bus.tell(BusEvent(kind))
        assert rig.tick() == [None]
    assert len(rig.log.lines) == 1
    assert rig.log.lines[0].startswith("WARN")
    assert rig.output.counters.events[kind] == 3


def test_row_59_can_only_without_a_bus_does_not_start() -> None:
    with pytest.raises(CanUnavailableError, match="'slcan:/nowhere' cannot be opened") as caught:
        start(OutputMode.CAN_ONLY, LogLines())
    assert caught.value.exit_code != 0


def test_row_59_with_dds_it_goes_on_and_says_so() -> None:
    log = LogLines()
    output = start(OutputMode.DDS_AND_CAN, log)
    assert output.send(REFERENCE, 0) is False
    assert len(log.lines) == 1
    assert log.lines[0].startswith("ERROR CAN bus 'slcan:/nowhere' cannot be opened")
    assert log.lines[0].endswith("commands go out over DDS alone")
    output.close()


def start(mode: OutputMode, log: LogLines) -> CanOutput:
    return start_output(mode, parse_spec("slcan:/nowhere"), PERIOD_S, FakeClock(), log)


def test_row_59_the_interface_goes_down_and_comes_back(rig: OutputRig) -> None:
    rig.bus.faults.append(CanResult.INTERFACE_DOWN)
    rig.bus.refusals = 1
    causes = rig.tick(count=5)
    assert causes[0] is Cause.INTERFACE_DOWN
    assert causes[-1] is None
    assert rig.bus.opened >= 2


@pytest.mark.parametrize("arbitration_id", [0x100, 0x101, 0x102])
def test_row_60_a_foreign_command_frame_raises_the_alarm(
    rig: OutputRig, arbitration_id: int
) -> None:
    for _ in range(2):
        rig.bus.tell(BusEvent(EventKind.FOREIGN_COMMAND, arbitration_id))
        rig.tick()
    assert rig.output.counters.events[EventKind.FOREIGN_COMMAND] == 2
    expected = f"ERROR another node sends our CAN frame 0x{arbitration_id:03X}"
    assert [line.split(":")[0] for line in rig.log.lines] == [expected]


UNDETECTABLE_BITS = {
    # The values themselves, which only the CRC of the CAN controller protects,
    *((index, bit) for index in (0, 1) for bit in range(64)),
    # the three flags,
    *((2, bit) for bit in (8, 9, 10)),
    # the sequence, where 43 for 42 could be one lost command,
    (2, 16),
    # and the stamp, which follows a clock that may be set.
    *((2, bit) for bit in range(32, 64)),
}


@pytest.mark.parametrize("index", [0, 1, 2])
def test_row_61_a_flipped_bit_is_refused_where_three_frames_can_show_it(index: int) -> None:
    for bit in range(64):
        receiver = CommandReceiver(PERIOD_S)
        for sequence in (40, 41):
            for frame in triple(sequence):
                receiver.feed(frame, sequence * PERIOD_S)
        frames = list(triple(42))
        word = int.from_bytes(frames[index].data, "little") ^ (1 << bit)
        frames[index] = frames[index]._replace(data=word.to_bytes(8, "little"))
        found = [receiver.feed(frame, 42 * PERIOD_S) for frame in frames][-1]
        assert (found is Verdict.ACCEPTED) is ((index, bit) in UNDETECTABLE_BITS), bit


def test_row_61_a_replayed_command_is_refused() -> None:
    receiver = CommandReceiver(PERIOD_S)
    log = [triple(sequence) for sequence in range(50)]
    for number, frames in enumerate(log):
        for frame in frames:
            receiver.feed(frame, number * PERIOD_S)
    now_s = 49 * PERIOD_S
    for frames in log:
        now_s += 0.001
        for frame in frames:
            assert receiver.feed(frame, now_s) in (Progress.PENDING, Verdict.NOT_ADVANCED)
    assert receiver.link(now_s) is Link.ALIVE
    assert receiver.command is not None
    assert receiver.command.sequence == 49


@pytest.mark.parametrize(
    ("value", "is_sent"),
    [
        (2147.4836, True),
        (2147.4838, False),
        (-2147.4836, True),
        (-2147.4839, False),
        (3.4e38, False),
        (float("inf"), False),
    ],
)
def test_row_62_an_angle_that_does_not_fit_rejects_all_three(
    rig: OutputRig, value: float, is_sent: bool
) -> None:
    (cause,) = rig.tick(Command(steering_tire_angle=value))
    assert (cause is None) is is_sent
    assert len(rig.bus.frames) == (3 if is_sent else 0)


def test_no_frame_waits_in_the_output_while_the_bus_is_down() -> None:
    """What is sent after a recovery is new: nothing of the time before it."""
    rig = OutputRig()
    rig.bus.faults.extend([CanResult.SENT, CanResult.BUS_OFF])
    rig.bus.refusals = 3
    causes = rig.tick(count=30)
    back = causes.index(None)
    assert back > 3
    rig.bus.frames.popleft()
    assert [c.sequence for c in rig.heard()] == list(range(back, 30))


def test_mock_bus_is_what_direct_link_opens_again() -> None:
    bus = MockBus()
    link = DirectLink(bus, FakeClock())
    link.open()
    bus.refusals = 1
    link.reopen()
    assert link.send(triple(), 0.01).result is CanResult.NOT_OPEN
    link.reopen()
    assert link.send(triple(), 0.01).result is CanResult.SENT
