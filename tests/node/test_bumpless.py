# SPDX-License-Identifier: Apache-2.0
"""Nothing jumps when the state changes: the real controllers, the shipped parameters.

A vehicle on a bend, whose driver holds another angle and another speed than the controllers would.
An angle is reached within T, at the MPC's rate limit, from the command before it or from the
measured angle, which the MPC takes for its last one as long as it has no control; the low pass
behind the limit (second order) overshoots by some percent. The first command that the vehicle
follows is within the limit of the measured angle. The PID bounds its output by ``max_jerk`` and
``min_jerk`` and remembers it in every state; a change of state clears only its integrator, so it
allows no more than that.
"""

from __future__ import annotations

import math

import pytest

from safety_island.control.follower import TrajectoryFollower
from safety_island.control.status import Mode
from safety_island.dds import topics
from safety_island.life_cycle.state import State
from safety_island.messages.arm import Arm, encode_arm
from safety_island.messages.outputs import Control
from safety_island.messages.wire import Time
from safety_island.params import from_mapping
from tests.node.rig import Point, Rig

ROWS: list[Point] = [(x - 5.0, 0.3 * math.sin(0.1 * x), 3.0) for x in range(120)]
PARAMETERS = from_mapping({})
T = PARAMETERS.node.ctrl_period
MOST_TURN = math.radians(60.0) * T
"""The highest rate limit of the set, that of slow driving on a bend."""
MOST_UP, MOST_DOWN = 2.0 * T, 5.0 * T
"""``max_jerk`` and ``min_jerk`` of the set."""
OVERSHOOT = 1.1
ROUNDING = 1e-6


class Drive:
    """A vehicle that moves along the path; ``speed`` and ``angle`` are what is measured."""

    def __init__(self, speed: float, angle: float) -> None:
        self.rig = Rig(TrajectoryFollower(PARAMETERS))
        self.x, self.speed, self.angle = 5.0, speed, angle
        self.sees = True
        self.engaged = False
        self.commands: list[Control] = []

    def tick(self) -> State:
        rig = self.rig
        self.x += self.speed * T
        if self.sees:
            rig.odometry(self.speed, self.x, 0.3 * math.sin(0.1 * (self.x + 5.0)))
        rig.steering(self.angle)
        rig.acceleration()
        rig.mode(Mode.AUTONOMOUS if self.engaged else Mode.LOCAL, True)
        rig.trajectory(ROWS)
        report = rig.tick(T)
        if report.published:
            assert report.command is not None
            self.commands.append(report.command)
        return report.life.state

    def until(self, state: State, ticks: int = 8) -> None:
        """Tick for a while, after which that state has come."""
        for _ in range(ticks):
            found = self.tick()
        assert found is state

    def assert_smooth(self) -> None:
        """Assert that no two of the last commands differ by more than limits allow."""
        before, after = self.commands[-2:]
        low, high = sorted((before.steering_tire_angle, self.angle))
        most = MOST_TURN * OVERSHOOT
        assert low - most <= after.steering_tire_angle <= high + most
        step = after.acceleration - before.acceleration
        assert -MOST_DOWN - ROUNDING <= step <= MOST_UP + ROUNDING
        assert after.velocity == before.velocity == 3.0

    def assert_near_the_measured_angle(self) -> None:
        """Assert that the last command can be reached from the measured angle within T."""
        angle = self.commands[-1].steering_tire_angle
        assert abs(angle - self.angle) <= MOST_TURN + ROUNDING


@pytest.fixture(params=[2.0, 3.0, 4.0], ids="{} m/s".format)
def speed(request: pytest.FixtureRequest) -> float:
    return float(request.param)


@pytest.fixture(params=[0.0, 0.05, -0.05, 0.3, -0.3], ids="{} rad".format)
def drive(request: pytest.FixtureRequest, speed: float) -> Drive:
    """In manual mode, after some ticks."""
    drive = Drive(speed, request.param)
    drive.until(State.READY)
    return drive


def test_from_ready_to_active_and_back(drive: Drive) -> None:
    for engaged in (True, False) * 3:
        drive.engaged = engaged
        drive.until(State.ACTIVE if engaged else State.READY, 1)
        drive.assert_smooth()


def test_the_first_command_that_counts_is_near_the_measured_angle(drive: Drive) -> None:
    drive.engaged = True
    drive.until(State.ACTIVE, 1)
    drive.assert_near_the_measured_angle()


def test_a_mode_that_changes_at_every_second_tick(drive: Drive) -> None:
    for tick in range(12):
        drive.engaged = tick % 4 > 1
        drive.tick()
        drive.assert_smooth()
        if drive.engaged:
            drive.angle = drive.commands[-1].steering_tire_angle


def test_the_way_out_of_silence(drive: Drive) -> None:
    drive.engaged = True
    drive.until(State.ACTIVE, 1)
    drive.sees = False
    drive.until(State.SILENT)
    sent = len(drive.commands)
    drive.sees = True
    drive.until(State.SILENT)
    assert len(drive.commands) == sent
    drive.engaged = False
    drive.until(State.READY, 1)
    drive.assert_smooth()
    drive.engaged = True
    drive.until(State.ACTIVE, 1)
    drive.assert_smooth()
    drive.assert_near_the_measured_angle()


def test_the_way_out_of_silence_by_a_request(drive: Drive) -> None:
    entry = topics.ARM
    asks = drive.rig.domain.publisher(entry.name, entry.type_name, entry.qos)
    drive.engaged = True
    drive.until(State.ACTIVE, 1)
    drive.sees = False
    drive.until(State.SILENT)
    drive.sees = True
    drive.until(State.SILENT)
    asks.write(encode_arm(Arm(Time(), 1)))
    drive.until(State.ACTIVE, 1)
    drive.assert_near_the_measured_angle()
    drive.angle = drive.commands[-1].steering_tire_angle
    for _ in range(3):
        drive.until(State.ACTIVE, 1)
        drive.assert_smooth()


def test_the_limits_are_those_of_the_set() -> None:
    raw = PARAMETERS.longitudinal
    assert (raw.max_jerk * T, -raw.min_jerk * T) == (MOST_UP, MOST_DOWN)
    limits = PARAMETERS.lateral.steer_rate_lim_dps_list_by_curvature
    assert math.radians(max(limits)) * T == MOST_TURN
