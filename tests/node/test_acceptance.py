# SPDX-License-Identifier: Apache-2.0
"""What Autoware's own tests of the controller node check, through the real node and controllers.

Vehicle at the origin, not accelerating, AUTONOMOUS (control not marked as enabled), as there; the
keeping of a standstill until the steering has converged is off unless a case is about it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import pytest

from safety_island.control.follower import TrajectoryFollower
from safety_island.messages.outputs import Control
from safety_island.node.report import Outcome
from safety_island.params import SETS, from_mapping
from tests.node.rig import Point, Rig

KEEP = "enable_keep_stopped_until_steer_convergence"
NewRig = Callable[..., Rig]


@pytest.fixture(params=sorted(SETS))
def new_rig(request: pytest.FixtureRequest) -> NewRig:
    """Makes a node with one of the shipped parameter sets."""

    def make(keep_stopped: bool = False) -> Rig:
        parameters = from_mapping({KEEP: keep_stopped}, request.param)
        return Rig(TrajectoryFollower(parameters))

    return make


def answer(rig: Rig, rows: Sequence[Point], vx: float = 0.0, steer: float = 0.0) -> Control:
    """Send all inputs, do one tick, return the command."""
    rig.everything(rows, vx, steer)
    assert rig.tick().published
    command = rig.command()
    assert command is not None
    return command


def line(speed: float, *places: float) -> list[Point]:
    """Points on the x axis."""
    return [(x, 0.0, speed) for x in places]


def far(speed: float) -> list[Point]:
    return line(speed, 0.0, 50.0, 100.0)


def test_no_input(new_rig: NewRig) -> None:
    rig = new_rig()
    for _ in range(10):
        assert rig.tick(0.1).outcome is Outcome.WAITING_FOR_INPUT
    assert rig.command() is None


def test_empty_trajectory(new_rig: NewRig) -> None:
    rig = new_rig()
    for _ in range(7):
        rig.everything([])
        assert not rig.tick().published
    assert rig.command() is None


def test_straight_trajectory(new_rig: NewRig) -> None:
    rig = new_rig()
    sent_at = rig.stamp
    command = answer(rig, line(1.0, -1.0, 0.0, 1.0, 2.0), vx=1.0)
    assert command.steering_tire_angle == 0.0
    assert command.steering_tire_rotation_rate == 0.0
    assert command.velocity > 0.0
    assert command.stamp > sent_at


@pytest.mark.parametrize(("side", "sign"), [("right", -1.0), ("left", 1.0)])
def test_turn(new_rig: NewRig, side: str, sign: float) -> None:
    rows = [(-1.0, sign, 1.0), (0.0, 0.0, 1.0), (1.0, sign, 1.0), (2.0, 2.0 * sign, 1.0)]
    command = answer(new_rig(), rows, vx=1.0)
    assert sign * command.steering_tire_angle > 0.0
    assert sign * command.steering_tire_rotation_rate > 0.0


def test_stopped_holds_the_measured_angle(new_rig: NewRig) -> None:
    command = answer(new_rig(), line(0.0, -1.0, 0.0, 1.0, 2.0), steer=-0.5)
    assert command.steering_tire_angle == -0.5
    assert command.steering_tire_rotation_rate == 0.0


def test_longitudinal_keep_velocity(new_rig: NewRig) -> None:
    rig = new_rig()
    for _ in range(2):
        command = answer(rig, far(1.0), vx=1.0)
        assert command.velocity == 1.0
        assert command.acceleration == 0.0


def test_longitudinal_slow_down(new_rig: NewRig) -> None:
    rig = new_rig()
    for _ in range(2):
        command = answer(rig, far(0.5), vx=1.0)
        assert command.velocity < 1.0
        assert command.acceleration < 0.0


def test_longitudinal_accelerate(new_rig: NewRig) -> None:
    rig = new_rig()
    for _ in range(2):
        command = answer(rig, far(1.0), vx=0.5)
        assert command.velocity > 0.5
        assert command.acceleration > 0.0


def test_longitudinal_stopped(new_rig: NewRig) -> None:
    command = answer(new_rig(), far(0.0))
    assert command.velocity == 0.0
    assert command.acceleration < 0.0


def test_longitudinal_reverse(new_rig: NewRig) -> None:
    command = answer(new_rig(), far(-1.0))
    assert command.velocity < 0.0
    assert command.acceleration > 0.0


def test_longitudinal_does_not_check_the_steering(new_rig: NewRig) -> None:
    assert answer(new_rig(), far(1.0), steer=-0.5).velocity == 1.0


def test_longitudinal_checks_the_steering(new_rig: NewRig) -> None:
    rig = new_rig(keep_stopped=True)
    for steer in (-0.5, 0.0, -0.5):
        assert answer(rig, far(1.0), steer=steer).velocity == 0.0
