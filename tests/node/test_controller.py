"""The tick of the controller node: its order, what it refuses, and what it tells."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from safety_island.control.status import Mode, MpcStatus, Refusal
from safety_island.dds import topics
from safety_island.messages.outputs import Control, decode_float64_stamped
from safety_island.messages.wire import Time
from safety_island.node.report import Outcome
from safety_island.platform import LogConfig, LogLevel
from tests.node.rig import FakeFollower, Point, Rig

ROWS: list[Point] = [(0.0, 0.0, 1.0), (1.0, 0.0, 1.0), (2.0, 0.0, 1.0)]


@pytest.fixture
def follower() -> FakeFollower:
    return FakeFollower()


@pytest.fixture
def rig(follower: FakeFollower) -> Rig:
    return Rig(follower)


class RecordingOutput:
    """Keeps what it is given; takes commands or not."""

    def __init__(self, name: str, works: bool = True) -> None:
        self.name = name
        self.failed = 0
        self.works = works
        self.sent: list[tuple[Control, int]] = []
        self.closed = False

    def send(self, command: Control, stamp_ns: int) -> bool:
        self.sent.append((command, stamp_ns))
        return self.works

    def close(self) -> None:
        self.closed = True


class TestOrder:
    def test_one_tick(self, rig: Rig, follower: FakeFollower) -> None:
        rig.odometry(vx=3.0, x=1.0, y=2.0)
        rig.steering(0.25)
        rig.acceleration(-0.5)
        rig.mode(Mode.LOCAL, enabled=True)
        rig.trajectory(ROWS)
        report = rig.tick(0.5)
        assert follower.calls == [
            ("trajectory", [0.0, 1.0, 2.0], 1000.0),
            ("odometry", 1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0, 3.0, 0.0, 0.0),
            ("steering", 0.25),
            ("acceleration", -0.5),
            ("operation mode", 3, True),
            ("is_ready",),
            ("lateral", 1000.5),
            ("longitudinal", 1000.5),
            ("sync",),
        ]
        assert report.published and report.detail == ""

    def test_only_the_newest_sample_is_offered(self, rig: Rig, follower: FakeFollower) -> None:
        for angle in (0.125, 0.25, 0.5):
            rig.steering(angle)
        rig.tick()
        rig.tick()
        assert follower.calls == [("steering", 0.5)]
        steering = next(item for item in rig.node.inputs if item.name == "steering")
        assert (steering.subscription.received, steering.subscription.superseded) == (3, 2)

    def test_a_tick_without_new_samples_uses_the_old_ones(self, rig: Rig) -> None:
        rig.everything(ROWS)
        assert rig.tick().published
        assert rig.tick().published


class TestMissingInput:
    @pytest.mark.parametrize("name", ["odometry", "steering", "acceleration", "mode"])
    def test_the_tick_is_skipped(self, rig: Rig, follower: FakeFollower, name: str) -> None:
        senders: dict[str, Callable[[], None]] = {
            "odometry": rig.odometry,
            "steering": rig.steering,
            "acceleration": rig.acceleration,
            "mode": rig.mode,
        }
        rig.trajectory(ROWS)
        for other in senders.keys() - {name}:
            senders[other]()
        shown = "operation mode" if name == "mode" else name
        report = rig.tick()
        assert (report.outcome, report.detail) == (Outcome.WAITING_FOR_INPUT, shown)
        assert [line.split("] ")[-1] for line in rig.lines] == [f"Waiting for {shown} data\n"]
        assert ("is_ready",) not in follower.calls
        assert rig.command() is None
        senders[name]()
        assert rig.tick().published

    def test_a_missing_trajectory(self, rig: Rig) -> None:
        for send in (rig.odometry, rig.steering, rig.acceleration, rig.mode):
            send()
        assert rig.tick().detail == "trajectory"
        rig.trajectory(ROWS)
        assert rig.tick().published

    def test_each_name_is_logged_once_in_three_seconds(self, rig: Rig) -> None:
        for _ in range(41):  # 6.15 s
            rig.tick()
        texts = [line.split("] ")[-1].strip() for line in rig.lines]
        names = ["trajectory", "odometry", "steering", "acceleration", "operation mode"]
        assert texts == [f"Waiting for {name} data" for name in names] * 3

    def test_what_was_always_refused_is_missing(self, rig: Rig, follower: FakeFollower) -> None:
        follower.refusal = Refusal.NOT_FINITE
        rig.everything(ROWS)
        assert rig.tick().outcome is Outcome.WAITING_FOR_INPUT


class TestRefusal:
    def test_a_bad_sample_is_counted_and_logged_by_topic_and_reason(self, rig: Rig) -> None:
        rig.everything(ROWS)
        rig.tick()
        for _ in range(3):
            rig.send(topics.ODOMETRY, b"\x00\x01\x00\x00" + bytes(40))
            assert rig.tick().refused == 1
        rig.send(topics.ODOMETRY, b"\x00\x07\x00\x00" + bytes(40))
        assert rig.tick().published  # on what is in force
        odometry = next(item for item in rig.node.inputs if item.name == "odometry")
        assert odometry.refused == {"truncated": 3, "encapsulation": 1}
        assert odometry.accepted == 1
        assert len([line for line in rig.lines if "/localization/kinematic_state" in line]) == 2

    def test_the_follower_s_refusals_are_counted(self, rig: Rig, follower: FakeFollower) -> None:
        rig.everything(ROWS)
        rig.tick()
        follower.refusal = Refusal.BAD_QUATERNION
        rig.odometry()
        assert rig.tick().refused == 1
        assert rig.node.inputs[1].refused == {"bad_quaternion": 1}
        assert "refused a sample: bad quaternion" in rig.lines[-1]

    def test_too_many_points_are_refused_before_they_are_copied(
        self, rig: Rig, follower: FakeFollower
    ) -> None:
        rig.trajectory([(float(i), 0.0, 1.0) for i in range(len(follower.incoming) + 1)])
        assert rig.tick().refused == 1
        assert rig.node.inputs[0].refused == {"length": 1}
        assert follower.calls == []

    def test_a_refused_sample_ages_like_one_that_never_came(
        self, rig: Rig, follower: FakeFollower
    ) -> None:
        rig.everything(ROWS)
        rig.tick()
        follower.refusal = Refusal.NOT_FINITE
        rig.odometry()
        ages = rig.tick(0.25).ages_s
        assert ages == pytest.approx((0.25,) * 5)


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

    def test_no_output_takes_it(self, follower: FakeFollower) -> None:
        rig = Rig(follower, [RecordingOutput("can", works=False)])
        rig.everything(ROWS)
        report = rig.tick()
        assert (report.outcome, report.detail) == (Outcome.OUTPUT_FAILED, "can")

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
        assert "refused a stale lateral command" in rig.lines[-1]

    def test_a_wall_clock_step_makes_nothing_stale(self, rig: Rig) -> None:
        rig.everything(ROWS)
        for offset_s in (0, -3600, 3600, 0):
            rig.clock.set_wall_offset_ns(offset_s * 10**9)
            assert rig.tick().published


class TestFailure:
    @pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
    def test_what_is_not_finite_is_never_sent(
        self, rig: Rig, follower: FakeFollower, value: float
    ) -> None:
        follower.command["velocity"] = value
        follower.command["acceleration"] = -value
        rig.everything(ROWS)
        assert rig.tick().outcome is Outcome.NOT_FINITE
        assert rig.command() is None

    @pytest.mark.parametrize("place", ["missing", "is_ready", "run_lateral", "sync"])
    def test_an_exception_costs_one_tick(
        self, rig: Rig, follower: FakeFollower, monkeypatch: pytest.MonkeyPatch, place: str
    ) -> None:
        def fail(*_: object) -> None:
            raise ZeroDivisionError("on purpose")

        with monkeypatch.context() as patch:
            patch.setattr(follower, place, fail)
            rig.everything(ROWS)
            report = rig.tick()
        assert report.outcome is Outcome.FAULT
        assert report.detail.startswith("ZeroDivisionError: on purpose (node/test_controller.py:")
        assert rig.command() is None
        rig.everything(ROWS)
        assert rig.tick().published

    def test_an_exception_over_a_sample_refuses_that_sample(
        self, rig: Rig, follower: FakeFollower, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def fail(*_: object) -> None:
            raise ZeroDivisionError("on purpose")

        rig.everything(ROWS)
        rig.tick()
        monkeypatch.setattr(follower, "offer_steering", fail)
        rig.steering()
        assert rig.tick().published
        assert rig.node.inputs[2].refused == {"fault": 1}
        assert "ZeroDivisionError: on purpose" in rig.lines[-1]

    def test_a_failed_mpc_still_gives_a_command_and_says_why(
        self, rig: Rig, follower: FakeFollower
    ) -> None:
        follower.lateral_status = MpcStatus.TOO_FAR
        rig.everything(ROWS)
        assert rig.tick().published
        assert "no new steering angle: too far" in rig.lines[-1]

    def test_controllers_that_are_not_ready(self, rig: Rig, follower: FakeFollower) -> None:
        follower.ready = False
        rig.everything(ROWS)
        assert rig.tick().outcome is Outcome.NOT_READY
        follower.ready, follower.longitudinal_state = True, -1
        assert rig.tick().outcome is Outcome.NOT_READY
        assert rig.command() is None


class TestRun:
    def test_a_duration_is_so_many_periods(self, rig: Rig) -> None:
        rig.everything(ROWS)
        reports: list[int] = []
        rig.node.observers.append(lambda report: reports.append(report.number))
        rig.node.run(0.15, duration_s=1.5)
        assert reports == list(range(1, 11))
        assert rig.clock.monotonic_ns() == 1_001_500_000_000

    def test_actions_between_the_ticks(self, rig: Rig) -> None:
        ages: list[float] = []
        rig.node.observers.append(lambda report: ages.append(round(report.ages_s[2], 9)))
        for time_ms in (100, 140, 350):
            rig.clock.call_at(1_000_000_000_000 + time_ms * 1_000_000, rig.steering)
        rig.node.run(0.15, duration_s=0.6)
        assert ages == [0.0, 0.15, 0.0, 0.15]

    def test_stop_ends_the_run_after_the_tick(self, rig: Rig) -> None:
        rig.node.observers.append(lambda report: rig.node.stop())
        rig.node.run(0.15)
        assert rig.node.report is not None and rig.node.report.number == 1

    def test_missed_ticks_are_told(self, rig: Rig, follower: FakeFollower) -> None:
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

    def test_it_says_that_it_is_live(self, rig: Rig) -> None:
        rig.node.run(0.03, duration_s=0.0)
        assert "safety_island is live, with a period of 30 ms" in rig.lines[0]

    def test_log_level_none_says_nothing(self, follower: FakeFollower) -> None:
        rig = Rig(follower, log=LogConfig(level=LogLevel.NONE))
        rig.node.run(0.15, duration_s=1.0)
        assert rig.lines == []

    def test_the_same_inputs_give_the_same_bytes(self) -> None:
        def drive() -> list[bytes]:
            rig = Rig(FakeFollower())
            sent: list[bytes] = []
            rig.node.observers.append(lambda report: sent.append(rig.commands.take_newest().data))
            rig.everything(ROWS)
            rig.node.run(0.15, duration_s=3.0)
            return sent

        assert drive() == drive()
