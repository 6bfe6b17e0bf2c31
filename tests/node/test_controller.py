# SPDX-License-Identifier: Apache-2.0
"""The tick of the controller node: its order, what it waits for, what it refuses."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from safety_island.control.status import Mode, Refusal
from safety_island.dds import topics
from safety_island.input_gate.reason import SampleReason
from safety_island.node.report import Outcome
from tests.node.rig import ROWS, FakeFollower, Rig


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
        steering = next(item for item in rig.node.inputs.items if item.name == "steering")
        assert (steering.subscription.received, steering.superseded) == (3, 2)

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

    def test_all_that_is_waited_for_is_one_line_in_three_seconds(self, rig: Rig) -> None:
        for _ in range(41):  # 6.15 s
            rig.tick()
        texts = [line.split("] ")[-1].strip() for line in rig.lines]
        every = "trajectory data, odometry data, steering data, acceleration data, "
        assert texts == [f"Waiting for {every}operation mode data"] * 3

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
            assert rig.tick(0.03).refused == 1
        rig.send(topics.ODOMETRY, b"\x00\x07\x00\x00" + bytes(40))
        assert rig.tick(0.03).published  # on what is in force
        odometry = next(item for item in rig.node.inputs.items if item.name == "odometry")
        assert odometry.refused == {SampleReason.TRUNCATED: 3, SampleReason.ENCAPSULATION: 1}
        assert odometry.accepted == 1
        assert len([line for line in rig.lines if "/localization/kinematic_state" in line]) == 2

    def test_the_follower_s_refusals_are_counted(self, rig: Rig, follower: FakeFollower) -> None:
        rig.everything(ROWS)
        rig.tick()
        follower.refusal = Refusal.BAD_QUATERNION
        rig.odometry()
        assert rig.tick().refused == 1
        assert rig.node.inputs.items[1].refused == {SampleReason.BAD_QUATERNION: 1}
        assert any("refused a sample: bad quaternion" in line for line in rig.lines)

    def test_too_many_points_are_refused_before_they_are_copied(
        self, rig: Rig, follower: FakeFollower
    ) -> None:
        rig.trajectory([(float(i), 0.0, 1.0) for i in range(len(follower.incoming) + 1)])
        assert rig.tick().refused == 1
        assert rig.node.inputs.items[0].refused == {SampleReason.LENGTH: 1}
        assert follower.calls == []

    def test_a_refused_sample_ages_like_one_that_never_came(
        self, rig: Rig, follower: FakeFollower
    ) -> None:
        rig.everything(ROWS)
        rig.tick()
        follower.refusal = Refusal.NOT_FINITE
        rig.odometry()
        ages = rig.tick(0.25).ages_s
        assert ages == pytest.approx(
            (0.4,) * 5
        )  # a period more: it may have come right after the tick before
