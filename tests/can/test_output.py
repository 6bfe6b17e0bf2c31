# SPDX-License-Identifier: Apache-2.0
"""CAN output: modes, sequence, counting, the log, and the record of what left."""

from __future__ import annotations

import math

import pytest

from safety_island.can.bus import BusEvent, EventKind
from safety_island.can.command import Cause, Command
from safety_island.can.output import CanOutput
from safety_island.command.mode import OutputMode
from safety_island.messages.outputs import Control, decode_control, encode_control
from safety_island.messages.wire import Time
from safety_island.node.outputs import Output
from safety_island.platform.interfaces import CanResult
from tests.can.output_rig import PERIOD_S, OutputRig
from tests.can.rig import REFERENCE, FakeClock, LogLines


@pytest.fixture
def rig() -> OutputRig:
    return OutputRig()


@pytest.mark.parametrize("mode", [OutputMode.CAN_ONLY, OutputMode.DDS_AND_CAN])
def test_each_command_is_three_frames_with_the_next_number(mode: OutputMode) -> None:
    rig = OutputRig(mode)
    assert rig.tick(count=2) == [None, None]
    assert len(rig.bus.frames) == 6
    assert [(c.sequence, c.mode) for c in rig.heard()] == [(0, mode), (1, mode)]
    assert rig.output.counters.sent == rig.output.counters.commands == 2


def test_dds_only_sends_nothing() -> None:
    rig = OutputRig(OutputMode.DDS_ONLY)
    assert rig.output.send(REFERENCE, 0) is False
    assert not rig.bus.frames
    assert rig.output.counters.commands == 0
    assert rig.output.last is None


def test_without_a_bus_it_does_nothing() -> None:
    log = LogLines()
    output = CanOutput(OutputMode.DDS_AND_CAN, None, 0.015, FakeClock(), log, open_failure="gone")
    assert output.send(REFERENCE, 0) is False
    assert log.lines == ["ERROR gone; commands go out over DDS alone"]
    output.close()


def test_it_is_an_output_of_the_node(rig: OutputRig) -> None:
    output: Output = rig.output
    assert (output.name, output.failed) == ("CAN", 0)
    output.close()
    assert rig.tick() == [Cause.NOT_OPEN]
    assert output.failed == 1


def test_the_values_are_those_of_the_dds_message(rig: OutputRig) -> None:
    """Also where single and double precision round to different last digits."""
    stamp = Time(1_700_000_000, 123_456_789)
    sent = Control(stamp, stamp, 0.1234565, 0.0000015, 12.2505, -0.0005, 0.0, True, True, False)
    rig.output.send(sent, stamp.nanoseconds)
    received = decode_control(encode_control(sent))
    heard = rig.heard()[0].command
    for name, scale in (
        ("steering_tire_angle", 1e6),
        ("steering_tire_rotation_rate", 1e6),
        ("velocity", 1e3),
        ("acceleration", 1e3),
    ):
        assert abs(getattr(heard, name) - getattr(received, name)) <= 0.5 / scale * (1 + 1e-9)
        assert round(getattr(heard, name) * scale) == round(getattr(received, name) * scale)
    assert rig.heard()[0].timestamp_ms == 1_700_000_000_123 % 2**32


def test_a_rejected_command_uses_up_its_number(rig: OutputRig) -> None:
    bad = REFERENCE._replace(velocity=math.nan)
    assert rig.tick() == [None]
    assert rig.tick(bad, 2) == [Cause.NOT_FINITE] * 2
    assert rig.tick() == [None]
    assert [c.sequence for c in rig.heard()] == [0, 3]
    counters = rig.output.counters
    assert (counters.sent, counters.rejected, counters.failed) == (2, 2, 0)
    assert counters.frames == {(0x101, Cause.NOT_FINITE): 2}
    assert rig.log.lines == [
        "ERROR CAN command rejected, nothing sent: velocity is nan, expected a finite number",
        "INFO CAN commands are valid again, after 2 rejected",
    ]


def test_counters_as_plain_values(rig: OutputRig) -> None:
    rig.bus.faults.extend([CanResult.SENT, CanResult.QUEUE_FULL])
    rig.bus.tell(BusEvent(EventKind.ERROR_WARNING))
    rig.tick(count=2)
    rig.tick(REFERENCE._replace(steering_tire_angle=1e9))
    assert rig.output.counters.as_dict() == {
        "commands": 3,
        "sent": 1,
        "rejected": 1,
        "failed": 1,
        "reopened": 0,
        "frames": {"0x100 out_of_range": 1, "0x101 queue_full": 1},
        "events": {"error_warning": 1},
    }


def test_a_trouble_that_lasts_is_one_line(rig: OutputRig) -> None:
    rig.bus.refusals = 50
    rig.bus.faults.append(CanResult.INTERFACE_DOWN)
    rig.tick(count=20)
    rig.bus.refusals = 0
    rig.tick(count=40)
    failed = rig.output.counters.failed
    assert rig.log.lines == [
        "ERROR CAN command not sent, frame 0x100: the interface is down",
        "ERROR CAN command not sent, frame 0x100: the bus is not open",
        f"INFO CAN output works again, after {failed} failed commands",
    ]


def test_a_bus_that_lasts_closed_is_tried_with_back_off(rig: OutputRig) -> None:
    rig.bus.refusals = 10_000
    rig.bus.faults.append(CanResult.INTERFACE_DOWN)
    rig.tick(count=400)  # a minute
    assert rig.output.counters.reopened < 25
    assert rig.output.counters.failed == 400


@pytest.mark.parametrize("sent", [0, 1, 2, 3])
def test_only_frames_that_left_are_recorded(rig: OutputRig, sent: int) -> None:
    rig.bus.faults.extend([CanResult.SENT] * sent + [CanResult.FAILED])
    stamp_ns = rig.clock.now_ns
    rig.tick()
    frames = tuple(rig.bus.frames)
    assert rig.recorded == ([(stamp_ns, frames)] if sent else [])
    assert len(frames) == sent


def test_each_event_is_told_once_until_the_controller_is_well(rig: OutputRig) -> None:
    for kind in (EventKind.ERROR_WARNING, EventKind.ERROR_PASSIVE, EventKind.ERROR_WARNING):
        rig.bus.tell(BusEvent(kind))
        rig.tick()
    rig.bus.tell(BusEvent(EventKind.ERROR_ACTIVE))
    rig.tick()
    rig.bus.tell(BusEvent(EventKind.ERROR_WARNING))
    rig.tick()
    assert [line.split(":")[0] for line in rig.log.lines] == [
        "WARN the CAN controller warns",
        "WARN the CAN controller is error-passive",
        "INFO CAN controller",
        "WARN the CAN controller warns",
    ]
    assert rig.output.counters.events[EventKind.ERROR_WARNING] == 3
    assert rig.output.counters.sent == 5


def test_an_open_failure_at_the_start_is_told_once_and_mended() -> None:
    rig = OutputRig()
    rig.bus.close()
    rig.bus.refusals = 1
    link = rig.output._link
    rig.output = CanOutput(
        OutputMode.DDS_AND_CAN, link, 0.015, rig.clock, rig.log, open_failure="no can0"
    )
    causes = rig.tick(count=4)
    assert causes[0] is Cause.NOT_OPEN
    assert causes[-1] is None
    assert rig.log.lines[0] == "ERROR no can0; commands go out over DDS alone"
    assert rig.log.lines[1].startswith("INFO CAN output works again")
    assert len(rig.log.lines) == 2


def test_closing_throws_away_what_waits_only_behind_a_bus_in_trouble(rig: OutputRig) -> None:
    rig.tick()
    rig.output.close()
    assert rig.bus.discarded == 0
    rig.tick()
    rig.output.close()
    assert rig.bus.discarded == 1


def test_the_budget_reaches_the_bus(rig: OutputRig) -> None:
    budgets: list[float] = []
    send = rig.bus.send

    def slow(frame: object, budget_s: float) -> CanResult:
        budgets.append(budget_s)
        rig.clock.advance(0.004)
        return send(frame, budget_s)  # type: ignore[arg-type]

    rig.bus.send = slow  # type: ignore[method-assign]
    assert rig.tick() == [None]
    assert budgets == pytest.approx([0.015, 0.011, 0.007])
    assert max(budgets) <= PERIOD_S / 10


def test_a_command_without_values_is_zero_and_undefined(rig: OutputRig) -> None:
    rig.tick(Command())
    assert rig.heard()[0].command == Command()


def foreign(rig: OutputRig, arbitration_id: int = 0x100) -> None:
    rig.bus.tell(BusEvent(EventKind.FOREIGN_COMMAND, arbitration_id))


def test_a_second_master_is_seen_without_sending(rig: OutputRig) -> None:
    assert rig.output.listen() == 0
    for count in (1, 2, 3):
        foreign(rig, 0x100 + count)
        assert rig.output.listen() == count
    assert [line.split(":")[0] for line in rig.log.lines] == [
        f"ERROR another node sends our CAN frame 0x10{i}" for i in (1, 2, 3)
    ]
    rig.clock.advance(0.999)
    assert rig.output.listen() == 3
    rig.clock.advance(0.001)
    assert rig.output.listen() == 0
    assert rig.log.lines[3:] == ["INFO no other node sends our CAN frames any more"]
    assert rig.output.listen() == 0
    assert len(rig.log.lines) == 4
    foreign(rig)
    assert rig.output.listen() == 1
    assert len(rig.log.lines) == 5


def test_a_command_that_was_sent_has_read_the_bus(rig: OutputRig) -> None:
    foreign(rig)
    rig.tick()
    foreign(rig)
    assert rig.output.listen() == 1  # the second one waits for the next command
    assert rig.output.listen() == 2


def test_without_a_bus_there_is_nothing_to_hear() -> None:
    output = CanOutput(OutputMode.DDS_AND_CAN, None, 0.015, FakeClock(), LogLines())
    assert output.listen() == 0
