# SPDX-License-Identifier: Apache-2.0
"""The life cycle in the node: what goes out in each state, and what the log says of it."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from safety_island.command.mode import OutputMode
from safety_island.control.status import Mode, MpcStatus
from safety_island.guard import Limit, Verdict
from safety_island.life_cycle.ramp import Motion
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.messages.outputs import Control
from safety_island.node.outgoing import OutgoingControl
from safety_island.node.report import Outcome, TickReport
from tests.node.rig import ROWS, FakeFollower, Rig
from tests.node.test_controller_output import RecordingOutput

T = 0.15


def tick(rig: Rig, stale: bool = False, engaged: bool = True, vx: float = 1.0) -> TickReport:
    """Send everything but, when stale, the odometry; then tick."""
    if not stale:
        rig.odometry(vx, x=rig.stamp.seconds - 1000.0)
    rig.steering()
    rig.acceleration()
    rig.mode(Mode.AUTONOMOUS if engaged else Mode.LOCAL, True)
    rig.trajectory(ROWS)
    return rig.tick(T)


def states(rig: Rig) -> list[str]:
    """What the log says of states."""
    return [line.split("] state ")[1].strip() for line in rig.lines if "] state " in line]


def can_only(follower: FakeFollower) -> tuple[Rig, RecordingOutput]:
    """A node whose vehicle hears CAN alone, engaged at 1 m/s."""
    follower.command["acceleration"] = 0.0
    follower.command["steering_tire_angle"] = 0.0625
    follower.command["velocity"] = 1.0
    can = RecordingOutput("can")
    rig = Rig(follower, [can], mode=OutputMode.CAN_ONLY)
    tick(rig, engaged=False)
    assert tick(rig).life.state is State.ACTIVE
    return rig, can


def motion(command: Control | OutgoingControl) -> tuple[float, float, float]:
    return (
        command.steering_tire_angle,
        round(command.velocity, 6),
        round(command.acceleration, 6),
    )


def test_a_command_that_was_refused_makes_no_predecessor_of_the_next_one(
    follower: FakeFollower,
) -> None:
    """Nor does it forget the one before: what jumps over it is clamped all the same."""
    rig = Rig(follower)
    tick(rig, engaged=False)
    follower.command["steering_tire_angle"] = 0.0
    for _ in range(3):
        assert tick(rig).published
    follower.command["steering_tire_angle"] = np.nan
    assert tick(rig).outcome is Outcome.NOT_FINITE
    follower.command["steering_tire_angle"] = 0.5
    report = tick(rig)
    assert report.published and report.command is not None
    assert rig.node.check.limits & Limit.RATE
    assert report.command.steering_tire_angle < 0.5


class TestCanOnly:
    def test_hold_then_stop_then_silence(self, follower: FakeFollower) -> None:
        rig, can = can_only(follower)
        reports = [tick(rig, stale=True) for _ in range(2)]
        assert all(report.published for report in reports)  # its age is 0.45 s
        sent = len(can.sent)
        reports = [tick(rig, stale=True) for _ in range(32)]
        names = [report.life.state.name for report in reports]
        count = names.count("STOP")
        assert names == ["HOLD"] * 2 + ["STOP"] * count + ["SILENT"] * (30 - count)
        assert {report.outcome for report in reports[: 2 + count]} == {Outcome.SUBSTITUTED}
        assert {report.outcome for report in reports[2 + count :]} == {Outcome.FORBIDDEN}
        assert len(can.sent) == sent + 2 + count
        assert all(report.life.cause is Reason.INPUT_STALE for report in reports)

    def test_the_commands_of_hold_and_of_the_ramp(self, follower: FakeFollower) -> None:
        rig, can = can_only(follower)
        for _ in range(2):
            tick(rig, stale=True)
        del can.sent[:]
        for _ in range(6):
            tick(rig, stale=True)
        # 2.5 m/s^3: 0.375 m/s^2 more at every tick of 0.15 s.
        assert [motion(command) for command, _ in can.sent] == [
            (0.0625, 1.0, 0.0),
            (0.0625, 1.0, 0.0),
            (0.0625, 0.94375, -0.375),
            (0.0625, 0.83125, -0.75),
            (0.0625, 0.6625, -1.125),
            (0.0625, 0.4375, -1.5),
        ]
        stamps = [stamp_ns for _, stamp_ns in can.sent]
        assert all(b - a == 150_000_000 for a, b in pairwise(stamps))

    def test_the_ramp_is_the_same_when_the_input_comes_back(
        self, follower: FakeFollower, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """The controllers run again, and want to drive; that takes time, too."""
        rig, can = can_only(follower)
        run_lateral = follower.run_lateral

        def take_time(now: float) -> MpcStatus:
            rig.clock.advance_to_ns(rig.clock.monotonic_ns() + 1_000_000)
            return run_lateral(now)

        monkeypatch.setattr(follower, "run_lateral", take_time)
        for _ in range(4):
            tick(rig, stale=True)
        del can.sent[:]
        reports = [tick(rig, stale=number == 0) for number in range(4)]
        assert {report.life.state for report in reports} == {State.STOP}
        expected = [(0.94375, -0.375), (0.83125, -0.75), (0.6625, -1.125), (0.4375, -1.5)]
        found = [motion(command)[1:] for command, _ in can.sent]
        assert found == [pytest.approx(pair, abs=0.01) for pair in expected]

    @pytest.mark.parametrize("input_is_back", [False, True])
    def test_the_guard_holds_them_against_each_other(
        self, follower: FakeFollower, monkeypatch: pytest.MonkeyPatch, input_is_back: bool
    ) -> None:
        """Not against what the controllers ask for, which is not sent."""
        rig, can = can_only(follower)
        for _ in range(5):
            tick(rig, stale=True)
        (before, _), jump = can.sent[-1], Motion(0.5, 0.0, 0.8, -0.75)
        monkeypatch.setattr(rig.node.life_cycle, "motion", lambda: jump)
        report = tick(rig, stale=not input_is_back)
        assert report.outcome is Outcome.SUBSTITUTED
        assert rig.node.check.limits & Limit.RATE
        now, _ = can.sent[-1]
        rate = rig.node.parameters.guard.steering_rate[0]
        step = now.steering_tire_angle - before.steering_tire_angle
        assert step == pytest.approx(rate * T, rel=0.05)  # a little less at 1 m/s

    @pytest.mark.parametrize("measured", [0.7, -0.7])
    def test_steering_that_does_not_follow_clamps_no_command_of_the_ramp(
        self, follower: FakeFollower, measured: float
    ) -> None:
        rig, can = can_only(follower)
        for _ in range(2):
            tick(rig, stale=True)
        del can.sent[:]
        rig.steering(measured)
        for _ in range(10):
            report = rig.tick(T)
            assert report.outcome is Outcome.SUBSTITUTED
            assert rig.node.check.limits == 0
        assert {motion(command)[0] for command, _ in can.sent} == {0.0625}

    def test_a_driver_who_takes_over_ends_the_ramp(self, follower: FakeFollower) -> None:
        rig, _ = can_only(follower)
        for _ in range(7):
            tick(rig, stale=True)
        report = tick(rig, engaged=False)
        assert (report.life.state, report.outcome) == (State.READY, Outcome.PUBLISHED)

    def test_the_log_has_one_line_for_each_state(self, follower: FakeFollower) -> None:
        rig, _ = can_only(follower)
        for _ in range(40):
            tick(rig, stale=True)
        assert states(rig) == [
            "READY: commands are sent, but the operation mode is not AUTONOMOUS with control"
            " enabled",
            "ACTIVE: all is well",
            "HOLD: odometry is older than its limit",
            "STOP: odometry is older than its limit",
            "SILENT: odometry is older than its limit",
        ]


class TestLog:
    """An output that fails makes READY and INIT alternate; each line is told every 3 s."""

    def failing(self, follower: FakeFollower, ticks: int) -> Rig:
        rig = Rig(follower, [RecordingOutput("dds", works=False)])
        found = {tick(rig, engaged=False).life.state for _ in range(ticks)}
        assert found == {State.READY, State.INIT}
        return rig

    def told(self, rig: Rig) -> list[str]:
        return [line.split(":")[0] for line in states(rig)]

    @pytest.mark.parametrize(("ticks", "lines"), [(19, 2), (38, 4)])
    def test_states_that_come_and_go_do_not_flood_it(
        self, follower: FakeFollower, ticks: int, lines: int
    ) -> None:
        assert self.told(self.failing(follower, ticks)) == ["READY", "INIT"] * (lines // 2)

    def test_another_reason_is_told_at_once(self, follower: FakeFollower) -> None:
        rig = self.failing(follower, 15)
        for _ in range(5):
            tick(rig, stale=True, engaged=False)
        assert self.told(rig) == ["READY", "INIT", "INIT"]
        assert states(rig)[-1] == "INIT: odometry is older than its limit"


class TestSilence:
    def silent(self, follower: FakeFollower) -> tuple[Rig, RecordingOutput]:
        output = RecordingOutput("dds")
        rig = Rig(follower, [output])
        tick(rig, engaged=False)
        tick(rig)
        assert follower.allowed
        for _ in range(5):
            report = tick(rig, stale=True)
        assert report.life == (State.SILENT, Reason.INPUT_STALE, Reason.INPUT_STALE)
        del output.sent[:], follower.calls[:]
        return rig, output

    def test_the_controllers_run_on_as_in_manual_mode(self, follower: FakeFollower) -> None:
        rig, output = self.silent(follower)
        for _ in range(5):
            report = tick(rig)
            assert report.life == (State.SILENT, Reason.LATCHED, Reason.INPUT_STALE)
            assert report.outcome is Outcome.FORBIDDEN and report.command is None
            assert not follower.allowed
        names = [call[0] for call in follower.calls]
        assert names.count("lateral") == names.count("longitudinal") == names.count("sync") == 5
        assert output.sent == []

    def test_without_their_inputs_they_do_not(self, follower: FakeFollower) -> None:
        rig, output = self.silent(follower)
        tick(rig, stale=True)
        assert "lateral" not in [call[0] for call in follower.calls]
        assert output.sent == []

    def test_the_first_command_after_it_has_no_predecessor(self, follower: FakeFollower) -> None:
        rig, _ = self.silent(follower)
        for _ in range(33):
            tick(rig)
        follower.command["steering_tire_angle"] = -0.125
        follower.command["acceleration"] = 0.0
        report = tick(rig, engaged=False)
        assert report.published and report.command is not None
        assert (rig.node.check.verdict, rig.node.check.limits) == (Verdict.PASSED, 0)
        assert motion(report.command)[0] == -0.125

    def test_engaging_anew_ends_it(self, follower: FakeFollower) -> None:
        rig, output = self.silent(follower)
        found = [tick(rig, engaged=engaged).life.state for engaged in (True, False, True)]
        assert found == [State.SILENT, State.READY, State.ACTIVE]
        assert len(output.sent) == 2
        assert follower.allowed

    def test_a_moving_vehicle_finds_a_started_island_silent(self, follower: FakeFollower) -> None:
        rig = Rig(follower)
        report = tick(rig, vx=1.0)
        assert report.life.reason is Reason.RESTARTED_WHILE_MOVING
        assert rig.command() is None
        assert len(states(rig)) == 1
