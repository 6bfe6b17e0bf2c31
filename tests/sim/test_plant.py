# SPDX-License-Identifier: Apache-2.0
"""The vehicle repeats the golden states, and does what a vehicle does."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from safety_island.sim.plant import GRAVITY, STEP_S, Plant, PlantParams

GOLDEN = Path(__file__).parents[1] / "golden" / "data"
CLEAN_RUNS = [
    "lane_change/ctrl0.15_unconstraint_fast",
    "s_curve/ctrl0.03_unconstraint_fast",
    "stop_and_go/ctrl0.15_unconstraint_fast",
    "u_turn/ctrl0.15_osqp",
    "reverse/ctrl0.15_unconstraint_fast",
]


def _repeat(run: str) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Drive the plant with the recorded commands; return (own, recorded) x, y, v, steer."""
    with np.load(GOLDEN / f"{run}.npz") as data:
        state, output = data["state"], data["output"]
    steps = round((state[1, 0] - state[0, 0]) / STEP_S)
    first = state[0]
    plant = Plant(
        x=first[1],
        y=first[2],
        yaw=2.0 * math.atan2(first[6], first[7]),
        speed=first[8],
        gear=-1 if state[:, 8].min() < 0.0 else 1,
    )
    own = []
    for row in output:
        own.append((plant.x, plant.y, plant.speed, plant.steering))
        if row[1]:
            plant.command(row[2], row[5])
        plant.advance(steps)
    return np.array(own), state[:, [1, 2, 8, 12]]


@pytest.mark.parametrize("run", CLEAN_RUNS)
def test_repeats_the_golden_states(run: str) -> None:
    own, recorded = _repeat(run)
    assert np.abs(own - recorded).max() < 1e-9


def test_repeats_the_golden_slope() -> None:
    """8 % up, a stop on the slope, a start that rolls back a little, and 6 % down."""
    with np.load(GOLDEN / "slope" / "ctrl0.03_unconstraint_fast.npz") as data:
        state, output = data["state"], data["output"]
    plant = Plant(x=state[0, 1], speed=state[0, 8])
    worst = 0.0
    for row, recorded in zip(output, state, strict=True):
        worst = max(worst, abs(plant.speed - recorded[8]), abs(plant.x - recorded[1]))
        if row[1]:
            plant.command(row[2], row[5])
        for _ in range(6):
            slope = np.interp(plant.x, [25.0, 35.0, 90.0, 105.0], [0.0, 0.08, 0.08, -0.06])
            plant.advance(1, float(slope))
    assert worst < 1e-9


def test_a_command_acts_after_its_dead_time() -> None:
    plant = Plant(speed=5.0)
    plant.command(0.1, 1.0)
    plant.advance(12)
    assert (plant.steering, plant.speed) == (0.0, 5.0)
    plant.advance(1)
    assert plant.steering == pytest.approx(0.1 * STEP_S / 0.2)
    assert plant.acceleration == pytest.approx(1.0 * STEP_S / 0.15)


def test_the_steps_of_one_advance_do_not_matter() -> None:
    whole, pieces = Plant(speed=5.0), Plant(speed=5.0)
    for plant in (whole, pieces):
        plant.command(0.2, -0.5)
        plant.advance(5)
        plant.command(-0.1, 0.5)
    whole.advance(100)
    for _ in range(100):
        pieces.advance(1)
    assert (whole.x, whole.y, whole.yaw) == (pieces.x, pieces.y, pieces.yaw)


def test_the_last_command_of_a_step_counts() -> None:
    plant = Plant(PlantParams(steering_dead_time=0.0, acceleration_dead_time=0.0))
    plant.command(0.5, 0.0)
    plant.command(0.1, 0.0)
    plant.advance(1)
    assert plant.steering == pytest.approx(0.1 * STEP_S / 0.2)


def test_settles_on_the_circle_of_its_angle() -> None:
    plant = Plant(speed=5.0)
    plant.command(0.2, 0.0)
    plant.advance(2000)
    assert plant.yaw_rate == pytest.approx(5.0 * math.tan(0.2) / 2.74, rel=1e-6)


def test_brakes_to_rest_and_stays() -> None:
    plant = Plant(speed=1.0)
    plant.command(0.0, -3.4)
    plant.advance(400)
    assert plant.speed == 0.0
    assert plant.acceleration == 0.0


@pytest.mark.parametrize("pitch", [0.08, -0.08])
def test_gravity_pulls_along_the_slope(pitch: float) -> None:
    plant = Plant(speed=5.0)
    plant.advance(1, pitch)
    assert plant.acceleration == pytest.approx(-GRAVITY * math.sin(pitch))


def test_rolls_back_when_it_drives_too_little_and_the_brake_catches_it() -> None:
    plant = Plant()
    plant.command(0.0, 0.5)
    plant.advance(200, 0.08)
    assert plant.speed < 0.0
    plant.command(0.0, -3.4)
    plant.advance(400, 0.08)
    assert plant.speed == 0.0


def test_a_weak_brake_does_not_hold_on_a_steep_slope() -> None:
    plant = Plant()
    plant.command(0.0, -0.3)
    plant.advance(400, 0.08)
    assert plant.speed < 0.0


def test_drives_in_reverse() -> None:
    plant = Plant(gear=-1)
    plant.command(0.0, 1.0)
    plant.advance(400)
    assert plant.speed < -1.0
    assert plant.x < 0.0
