# SPDX-License-Identifier: Apache-2.0
"""What a tick sends, and what it does not send."""

from __future__ import annotations

import pytest

from safety_island.control.status import MpcStatus
from safety_island.dds import topics
from safety_island.messages.outputs import Control, decode_float64_stamped
from safety_island.messages.wire import Time
from safety_island.node.memory import MemoryPublisher
from safety_island.node.outgoing import OutgoingControl
from safety_island.node.report import Outcome
from tests.node.rig import ROWS, FakeFollower, Rig


class RecordingOutput:
    """Keeps what it is given; takes commands or not."""

    def __init__(self, name: str, works: bool = True) -> None:
        self.name = name
        self.failed = 0
        self.works = works
        self.sent: list[tuple[OutgoingControl, int]] = []
        self.foreign_frames = 0
        self.closed = False

    def send(self, command: OutgoingControl, stamp_ns: int) -> bool:
        self.sent.append((command, stamp_ns))
        return self.works

    def listen(self) -> int:
        return self.foreign_frames

    def close(self) -> None:
        self.closed = True


class TestOutput:
    def test_the_message(self, rig: Rig) -> None:
        rig.everything(ROWS)
        report = rig.tick(0.5)
        stamp = Time(1000, 500_000_000)
        assert rig.command() == Control(
            stamp, stamp, 0.125, 0.0, 0.0, -1.5, is_defined_acceleration=True, lateral_stamp=stamp
        )
        assert report.command is not None and report.command.acceleration == -1.5

    def test_stamps_are_on_the_wall_clock(self, rig: Rig, follower: FakeFollower) -> None:
        rig.clock.set_wall_offset_ns(7_000_000_000)
        rig.everything(ROWS)
        rig.tick(0.5)
        command = rig.command()
        assert command is not None
        assert command.stamp == command.longitudinal_stamp == Time(1007, 500_000_000)
        assert follower.calls[-2] == ("longitudinal", 1000.5)

    def test_the_longitudinal_part_keeps_its_own_stamp(
        self, rig: Rig, follower: FakeFollower, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        follower.command["longitudinal_stamp"] = 1000.25
        monkeypatch.setattr(follower, "run_longitudinal", lambda now: 0)
        rig.everything(ROWS)
        rig.tick(0.5)
        command = rig.command()
        assert command is not None
        assert command.longitudinal_stamp == Time(1000, 250_000_000)
        assert command.stamp == command.lateral_stamp == Time(1000, 500_000_000)

    def test_processing_times_are_published(
        self, rig: Rig, follower: FakeFollower, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def take(seconds: float) -> MpcStatus:
            rig.clock.advance_to_ns(rig.clock.monotonic_ns() + round(seconds * 1e9))
            return MpcStatus.SOLVED

        subscriptions = [rig.listen(t) for t in (topics.LATERAL_TIME, topics.LONGITUDINAL_TIME)]
        monkeypatch.setattr(follower, "run_lateral", lambda now: take(0.003))
        monkeypatch.setattr(follower, "sync", lambda: take(0.1))
        rig.everything(ROWS)
        report = rig.tick()
        found = [decode_float64_stamped(t.take_newest().data)[1] for t in subscriptions]
        assert found == [3.0, 0.0]
        assert (report.lateral_time_s, report.tick_time_s) == (0.003, 0.103)

    def test_every_output_gets_the_command_whatever_the_others_do(
        self, follower: FakeFollower
    ) -> None:
        broken, working = RecordingOutput("can", works=False), RecordingOutput("dds")
        rig = Rig(follower, [broken, working])
        rig.everything(ROWS)
        assert rig.tick(0.5).published
        assert broken.sent == working.sent
        assert working.sent[0][1] == 1_000_500_000_000
        assert rig.command() is None  # that topic is an output of its own

    def test_every_output_gets_the_command_when_all_take_it(self, follower: FakeFollower) -> None:
        dds, can = RecordingOutput("dds"), RecordingOutput("can")
        rig = Rig(follower, [dds, can])
        rig.everything(ROWS)
        assert rig.tick().published
        assert len(dds.sent) == len(can.sent) == 1
        assert dds.sent == can.sent

    def test_no_output_takes_it(self, follower: FakeFollower) -> None:
        rig = Rig(follower, [RecordingOutput("can", works=False)])
        rig.everything(ROWS)
        report = rig.tick()
        assert (report.outcome, report.detail) == (Outcome.OUTPUT_FAILED, "can")

    def test_silence_takes_the_last_command_back(self, rig: Rig) -> None:
        rig.everything(ROWS)
        assert rig.tick().published
        assert rig.listen(topics.CONTROL).take_newest() is not None
        assert not rig.tick(0.6).published
        assert rig.listen(topics.CONTROL).take_newest() is None
        rig.everything(ROWS)
        assert rig.tick().published
        assert rig.listen(topics.CONTROL).take_newest() is not None

    def test_the_last_command_is_taken_back_once(
        self, rig: Rig, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        taken_back: list[MemoryPublisher] = []
        monkeypatch.setattr(
            MemoryPublisher, "withdraw", lambda publisher: taken_back.append(publisher)
        )
        for count in (1, 2):
            rig.everything(ROWS)
            assert rig.tick().published
            assert not any(rig.tick(0.6).published for _ in range(5))
            assert len(taken_back) == count

    def test_outputs_are_closed_with_the_node(self, follower: FakeFollower) -> None:
        output = RecordingOutput("can")
        with Rig(follower, [output]).node:
            assert not output.closed
        assert output.closed


class TestStale:
    def test_a_lateral_result_that_stays_away(self, rig: Rig, follower: FakeFollower) -> None:
        rig.everything(ROWS)
        assert rig.tick().published
        follower.lateral_status = MpcStatus.NO_REFERENCE
        report = rig.tick()
        assert report.outcome is Outcome.NOT_READY
        assert rig.command() is not None  # the first tick's, and no other
        assert not rig.tick().published and rig.command() is None

    @pytest.mark.parametrize(("age_s", "outcome"), [(0.5, 0), (0.501, 3)])
    def test_a_longitudinal_result_older_than_the_limit(
        self,
        rig: Rig,
        follower: FakeFollower,
        monkeypatch: pytest.MonkeyPatch,
        age_s: float,
        outcome: int,
    ) -> None:
        def keep_old(now: float) -> int:
            follower.command["longitudinal_stamp"] = now - age_s
            return 0

        monkeypatch.setattr(follower, "run_longitudinal", keep_old)
        rig.everything(ROWS)
        report = rig.tick()
        assert report.outcome == outcome
        assert report.detail == ("longitudinal" if outcome else "")
        assert (rig.command() is None) == bool(outcome)

    def test_a_computation_that_takes_longer_than_the_limit(
        self, rig: Rig, follower: FakeFollower, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def stall() -> None:
            rig.clock.advance_to_ns(rig.clock.monotonic_ns() + 600_000_000)

        monkeypatch.setattr(follower, "sync", stall)
        rig.everything(ROWS)
        report = rig.tick()
        assert (report.outcome, report.detail) == (Outcome.STALE, "lateral")
        assert any("the guard refused a command: stale" in line for line in rig.lines)

    def test_a_wall_clock_step_makes_nothing_stale(self, rig: Rig) -> None:
        rig.everything(ROWS)
        for offset_s in (0, -3600, 3600, 0):
            rig.clock.set_wall_offset_ns(offset_s * 10**9)
            assert rig.tick(0.05).published
