# SPDX-License-Identifier: Apache-2.0
"""What holds a vehicle whose commands are sent: by its status, and as the node makes it."""

from __future__ import annotations

import math
from random import Random
from typing import Any

import pytest

from safety_island.control.status import ControllerLimit, LongitudinalState, MpcStatus
from safety_island.dds.topics import STATUS
from safety_island.guard import Limit
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.messages.status import NO_VALUE, decode_status
from safety_island.messages.status_fields import Status
from safety_island.params import load_set
from safety_island.sim.closed_loop import ClosedLoop
from safety_island.sim.courses import load_course
from safety_island.status.holds import EXPLANATIONS, MPC_EXPLANATIONS, HoldReason, holds
from safety_island.status.why import flows, held_by, is_free, why, why_values
from tests.sim.random_drives import NodeFollower
from tests.status.samples import ODOMETRY, sample

STOPPED: dict[str, Any] = {
    "longitudinal_state": LongitudinalState.STOPPED,
    "command_acceleration": -3.4,
    "controller_limits": 0,
}
STANDS = STOPPED | {"stop_dist": 0.02}
EMERGENCY: dict[str, Any] = {"longitudinal_state": LongitudinalState.EMERGENCY}

CASES: dict[HoldReason, tuple[Status, str]] = {
    HoldReason.STEERING_NOT_CONVERGED: (
        sample(**STOPPED | {"controller_limits": ControllerLimit.SLOW_START}),
        "the brake of STOPPED (-3.40 m/s²) is kept until the steering has converged",
    ),
    HoldReason.STOP_POINT: (sample(**STANDS), "has its stop point 0.02 m ahead"),
    HoldReason.STOPPING: (
        sample(longitudinal_state=LongitudinalState.STOPPING, stop_dist=0.4),
        "the controller is STOPPING (-0.23 m/s²): the trajectory has its stop point 0.40 m ahead",
    ),
    HoldReason.FAR_FROM_TRAJECTORY: (
        sample(**EMERGENCY, controller_limits=512 + 1024, lateral_error=3.4),
        "'emergency_state_traj_rot_dev' (lateral error +3.40 m, yaw error -0.00 rad)",
    ),
    HoldReason.PAST_STOP_POINT: (
        sample(**EMERGENCY, controller_limits=0, stop_dist=-1.7),
        "has passed the stop point (at -1.70 m)",
    ),
    HoldReason.EMERGENCY: (sample(**EMERGENCY, controller_limits=0), "leaves that state at rest"),
    HoldReason.BRAKE_KEEPING: (
        sample(controller_limits=ControllerLimit.BRAKE_KEEPING),
        "a light brake (-0.23 m/s²) is kept up to the stop point 63.00 m ahead",
    ),
    HoldReason.TARGET_SPEED_ZERO: (
        sample(target_vel=0.002),
        "the trajectory asks for 0.002 m/s where the vehicle is; look why the planner",
    ),
    HoldReason.MPC_FAILED: (
        sample(mpc_status=MpcStatus.TOO_FAR),
        "the last one is held: TOO_FAR (lateral error +0.03 m, yaw error -0.00 rad); publish a",
    ),
    HoldReason.GUARD: (
        sample(guard_verdict=1, guard_limits=Limit.ACCELERATION | Limit.JERK),
        "the guard changes commands (1 of the last 1; ACCELERATION, JERK): it drives off or brakes",
    ),
}


@pytest.mark.parametrize("reason", CASES)
def test_it_is_named_with_its_numbers_and_what_to_do(reason: HoldReason) -> None:
    status, words = CASES[reason]
    (hold,) = holds([status])
    assert hold.reason is reason and words in f"{hold.meaning}; {hold.action}"
    sentence = why(status)
    assert sentence == f"Commands are sent, but {hold.meaning}; {hold.action}."
    assert "All is well" not in sentence and not set("{}`") & set(sentence)
    assert flows(status) and not is_free([status])


def test_there_is_a_case_for_every_one_and_a_row() -> None:
    assert set(EXPLANATIONS) == set(HoldReason) == {*CASES, HoldReason.OUTPUT_FAILED}
    assert all(meaning and action for meaning, action in EXPLANATIONS.values())
    assert list(MPC_EXPLANATIONS) == list(MpcStatus)
    assert all(meaning and action for meaning, action in MPC_EXPLANATIONS.values())


@pytest.mark.parametrize("mpc", [status for status in MpcStatus if status is not MpcStatus.SOLVED])
def test_every_failure_of_the_mpc_says_what_to_do(mpc: MpcStatus) -> None:
    action = MPC_EXPLANATIONS[mpc].action.replace("`", "'")
    assert why(sample(mpc_status=mpc)).endswith(f"; {action}.")
    silent: dict[str, Any] = {"state": State.SILENT, "published": False}
    silent |= {"reason": Reason.MPC_FAILED, "mpc_status": mpc}
    assert action in why(sample(**silent))


def test_a_state_of_a_newer_island_is_told_all_the_same() -> None:
    assert "99 (lateral" in why(sample(mpc_status=99))
    assert "use the version of the island" in why(sample(guard_limits=1 << 20))


def test_the_vehicle_is_free_when_nothing_holds_it() -> None:
    status = sample({ODOMETRY: {"warnings": 1}})
    assert is_free([status]) and not holds([status])
    assert why(status).startswith("All is well, with a warning of odometry")
    not_run = sample(longitudinal_state=NO_VALUE, mpc_status=NO_VALUE, target_vel=math.nan)
    assert not holds([not_run])


@pytest.mark.parametrize("state", [state for state in State if state is not State.ACTIVE])
def test_out_of_active_the_reason_says_it(state: State) -> None:
    assert not holds([sample(**STANDS, state=state)])
    assert not is_free([sample(**STANDS, state=state, reason=Reason.NOT_AUTONOMOUS)])


def test_what_comes_and_goes_is_seen_in_the_ticks_before() -> None:
    clamped = sample(guard_verdict=1, guard_limits=Limit.LATERAL_JERK)
    before = [sample(), clamped, sample(), clamped]
    told = why(sample(), before)
    assert "the guard changes commands (2 of the last 5; LATERAL_JERK)" in told
    assert why(sample(), [sample()] * 4).startswith("All is well")


def test_an_output_that_fails_while_another_one_sends() -> None:
    told = why(sample(output_failures=7), [sample(output_failures=3)])
    assert "an output fails (4 failures in the last 2 commands, 7 so far)" in told
    assert held_by([sample(output_failures=7)] * 2) == []


def test_several_are_told_one_after_the_other() -> None:
    status = sample(**STANDS, mpc_status=MpcStatus.TOO_FAR)
    first, second = why(status).split(". Also, ")
    assert "STOPPED" in first and "TOO_FAR" in second
    assert held_by([status]) == ["STOP_POINT", "MPC_FAILED"]
    late = why(sample(**STANDS, degraded=True))
    assert late.startswith("Commands are sent, but ticks come too late") and "STOPPED" in late


def test_json_has_the_same() -> None:
    status = sample(**STANDS)
    assert why_values(status, [], None) == {
        "flows": True,
        "free": False,
        "held_by": ["STOP_POINT"],
        "why": why(status),
    }
    assert why_values(sample(), [], None)["free"] is True


class Drive:
    """The whole node on a course, on virtual time, as its status tells it."""

    def __init__(self, course: str = "straight") -> None:
        parameters = load_set("default")
        self.follower = Undisturbed(parameters, Quiet())
        domain = self.follower.domain
        self._status = domain.subscription(STATUS.name, STATUS.type_name, STATUS.qos)
        self.loop = ClosedLoop(self.follower, load_course(course), parameters.node.ctrl_period)

    def run(self, seconds: float) -> list[Status]:
        """Drive on; the statuses of that time."""
        found = []
        for _ in range(round(seconds / self.loop.period_s)):
            self.follower.at(self.loop.now)
            self.loop.tick()
            found += [decode_status(sample.data) for sample in self._status.take_all()]
        return found


class Quiet(Random):
    """Sensors without noise."""

    def gauss(self, mu: float = 0.0, sigma: float = 1.0) -> float:
        return mu


class Undisturbed(NodeFollower):
    """A vehicle whose steering sensor may be stuck [rad]."""

    stuck: float | None = None

    def offer_steering(self, angle: float) -> None:
        super().offer_steering(angle if self.stuck is None else self.stuck)


def test_steering_that_does_not_converge_is_named_in_a_real_drive() -> None:
    drive = Drive()
    drive.follower.stuck = 0.4
    last = drive.run(5.0)[-1]
    assert (last.state, last.longitudinal_state) == (State.ACTIVE, LongitudinalState.STOPPED)
    assert last.command_acceleration == pytest.approx(-3.4)
    assert held_by([last]) == ["STEERING_NOT_CONVERGED"]
    assert "until the steering has converged" in why(last)
    drive.follower.stuck = None
    assert is_free(drive.run(8.0)[-1:])


def test_a_drive_is_held_before_it_starts_and_after_it_ends() -> None:
    statuses = Drive("stop-and-go").run(60.0)
    seen = [held_by([status]) for status in statuses]
    assert ["STEERING_NOT_CONVERGED"] in seen[:40] and ["STOPPING"] in seen
    assert seen[-1] == ["STOP_POINT"]
    driving = [
        not held for held, status in zip(seen, statuses, strict=True) if status.target_vel > 1
    ]
    assert sum(driving) > 0.9 * len(driving)


def test_a_vehicle_set_aside_is_far_from_its_trajectory() -> None:
    drive = Drive()
    drive.run(15.0)
    drive.loop.plant.y += 4.0
    assert "FAR_FROM_TRAJECTORY" in held_by(drive.run(0.45)[-1:])
