# SPDX-License-Identifier: Apache-2.0
"""How a run ends: at once, or with CAN alone after the declared stop."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from safety_island.command.mode import OutputMode
from safety_island.control.status import Mode
from safety_island.dds import topics
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.messages.status import decode_status
from safety_island.node.node import SAME_REQUEST_NS
from safety_island.node.report import TickReport
from tests.faults.hands import fail_with
from tests.node.rig import ROWS, FakeFollower, Rig
from tests.node.test_controller_output import RecordingOutput
from tests.node.test_life_cycle import T, motion, states, tick


class Drive:
    """A vehicle at 1 m/s that hears CAN alone; something happens after a number of ticks."""

    def __init__(
        self,
        follower: FakeFollower,
        mode: OutputMode = OutputMode.CAN_ONLY,
        vx: float = 1.0,
        acceleration: float = 0.0,
    ) -> None:
        follower.command["acceleration"] = acceleration
        follower.command["velocity"] = vx
        follower.command["steering_tire_angle"] = 0.0625
        self.can = RecordingOutput("can")
        self.rig = Rig(follower, [self.can], mode=mode)
        self.vx, self.engaged = vx, True
        tick(self.rig, engaged=False, vx=vx)
        assert tick(self.rig, vx=vx).life.state is State.ACTIVE
        del self.can.sent[:]
        self.reports: list[TickReport] = []
        self.after: dict[int, Callable[[], None]] = {}
        self.rig.node.observers.append(self._observe)

    def _observe(self, report: TickReport) -> None:
        self.reports.append(report)
        self.after.get(len(self.reports), lambda: None)()
        self.send()

    def send(self) -> None:
        rig = self.rig
        rig.odometry(self.vx, x=rig.stamp.seconds - 1000.0)
        rig.steering()
        rig.acceleration()
        rig.mode(Mode.AUTONOMOUS if self.engaged else Mode.LOCAL, True)
        rig.trajectory(ROWS)

    def run(self, duration_s: float | None = 600.0) -> list[str]:
        """Run to the end; return the states of the ticks."""
        self.send()
        self.rig.node.run(T, duration_s)
        return [report.life.state.name for report in self.reports]


def stop_of(names: list[str]) -> list[str]:
    """The part of the states that is the declared stop, which must be whole."""
    count = names.count("STOP")
    assert count > 5
    assert names == ["ACTIVE"] * names.count("ACTIVE") + ["HOLD"] * 2 + ["STOP"] * count + [
        "SILENT"
    ]
    return names[names.index("HOLD") :]


class TestCanOnly:
    def test_told_to_end_it_stops_the_vehicle_first(self, follower: FakeFollower) -> None:
        drive = Drive(follower)
        drive.after[4] = drive.rig.node.stop
        names = drive.run()
        assert names.count("ACTIVE") == 4
        count = len(stop_of(names)) - 1
        assert len(drive.can.sent) == 4 + count
        found = [motion(command) for command, _ in drive.can.sent[4:10]]
        assert found == [
            (0.0625, 1.0, 0.0),
            (0.0625, 1.0, 0.0),
            (0.0625, 0.94375, -0.375),
            (0.0625, 0.83125, -0.75),
            (0.0625, 0.6625, -1.125),
            (0.0625, 0.4375, -1.5),
        ]
        assert motion(drive.can.sent[-1][0])[1] == 0.0
        assert drive.reports[-1].life == (
            State.SILENT,
            Reason.SHUTTING_DOWN,
            Reason.SHUTTING_DOWN,
        )

    def test_every_phase_of_the_tick(self, follower: FakeFollower) -> None:
        """The request comes while inputs are taken, and while the timer waits."""
        for delay_ms in (0, 20, 75, 149):
            drive = Drive(FakeFollower())
            now_ns = drive.rig.clock.monotonic_ns()
            at_ns = now_ns + 600_000_000 + delay_ms * 1_000_000
            drive.rig.clock.call_at(at_ns, drive.rig.node.stop)
            stop_of(drive.run())

    def test_the_end_of_the_planned_time_is_no_other(self, follower: FakeFollower) -> None:
        drive = Drive(follower)
        names = drive.run(1.5)
        assert names.count("ACTIVE") == 10
        stop_of(names)

    def test_the_status_names_the_cause(self, follower: FakeFollower) -> None:
        drive = Drive(follower)
        drive.after[4] = drive.rig.node.stop
        heard = drive.rig.listen(topics.STATUS)
        drive.run()
        found = [decode_status(sample.data) for sample in heard.take_all()]
        assert {one.reason for one in found if one.state != State.ACTIVE} == {Reason.SHUTTING_DOWN}
        lines = states(drive.rig)
        assert [line.split(":")[0] for line in lines[-3:]] == ["HOLD", "STOP", "SILENT"]
        assert all("the island was told to end" in line for line in lines[-3:])

    def test_told_again_it_ends_after_the_tick(self, follower: FakeFollower) -> None:
        drive = Drive(follower)
        drive.after = {4: drive.rig.node.stop, 8: drive.rig.node.stop}
        assert drive.run() == ["ACTIVE"] * 4 + ["HOLD"] * 2 + ["STOP"] * 2

    def test_two_signals_of_one_request_are_one(self, follower: FakeFollower) -> None:
        """``timeout`` and a shell signal the process and its group."""
        drive = Drive(follower)
        node, clock = drive.rig.node, drive.rig.clock

        def twice() -> None:
            node.stop()
            clock.call_at(clock.monotonic_ns() + SAME_REQUEST_NS, node.stop)

        drive.after[4] = twice
        stop_of(drive.run())

    def test_a_request_during_the_stop_for_the_planned_end_is_the_first(
        self, follower: FakeFollower
    ) -> None:
        drive = Drive(follower)
        drive.after[12] = drive.rig.node.stop
        stop_of(drive.run(1.5))

    def test_an_operator_who_takes_over_need_not_wait(self, follower: FakeFollower) -> None:
        drive = Drive(follower)

        def take_over() -> None:
            drive.engaged = False

        drive.after = {4: drive.rig.node.stop, 8: take_over}
        assert drive.run() == ["ACTIVE"] * 4 + ["HOLD"] * 2 + ["STOP"] * 2 + ["INIT"]

    @pytest.mark.parametrize(
        ("vx", "acceleration", "ends_at_once"), [(0.0, -1.0, True), (0.0, 0.5, False)]
    )
    def test_at_standstill(
        self, follower: FakeFollower, vx: float, acceleration: float, ends_at_once: bool
    ) -> None:
        drive = Drive(follower, vx=vx, acceleration=acceleration)
        drive.after[4] = drive.rig.node.stop
        names = drive.run()
        assert (names == ["ACTIVE"] * 4) is ends_at_once
        assert names[-1] == ("ACTIVE" if ends_at_once else "SILENT")

    def test_not_engaged_it_ends_at_once(self, follower: FakeFollower) -> None:
        drive = Drive(follower)
        drive.engaged = False
        drive.after[4] = drive.rig.node.stop
        assert drive.run() == ["READY"] * 4

    def test_it_does_not_arm_any_more(self, follower: FakeFollower) -> None:
        """Engaged in the very tick in which it is told to end."""
        drive = Drive(follower)
        drive.engaged = False

        def engage_and_end() -> None:
            drive.engaged = True
            drive.rig.node.stop()

        drive.after[4] = engage_and_end
        assert drive.run() == ["READY"] * 4

    @pytest.mark.parametrize("broken", ["take", "blocked"])
    def test_a_fault_in_every_tick_does_not_keep_it(
        self, follower: FakeFollower, monkeypatch: pytest.MonkeyPatch, broken: str
    ) -> None:
        drive = Drive(follower)

        def end() -> None:
            monkeypatch.setattr(drive.rig.node.inputs, broken, fail_with(ZeroDivisionError()))
            drive.rig.node.stop()

        drive.after[4] = end
        names = drive.run()
        assert names[-1] == "SILENT"
        assert names.count("STOP") > 5
        assert len(names) < 60


@pytest.mark.parametrize("mode", [OutputMode.DDS_ONLY, OutputMode.DDS_AND_CAN])
def test_with_a_gate_that_brakes_it_ends_at_once(follower: FakeFollower, mode: OutputMode) -> None:
    drive = Drive(follower, mode)
    drive.after[4] = drive.rig.node.stop
    assert drive.run() == ["ACTIVE"] * 4


def test_a_request_before_the_run_is_not_lost(follower: FakeFollower) -> None:
    drive = Drive(follower, OutputMode.DDS_ONLY)
    drive.rig.node.stop()
    assert drive.run() == []


def test_a_request_is_over_with_its_run(follower: FakeFollower) -> None:
    """A planned end leaves nothing behind for the next run."""
    drive = Drive(follower, OutputMode.DDS_ONLY)
    assert drive.run(0.6) == ["ACTIVE"] * 4
    assert drive.run(0.6) == ["ACTIVE"] * 8
