# SPDX-License-Identifier: Apache-2.0
"""The vehicle behind its gate on virtual time: engaging, silence, standstill of the process."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from safety_island.control.status import Mode
from safety_island.sim.courses import load_course
from safety_island.sim.gate import GateState
from safety_island.sim.world import MOST_STEPS, SETTLE_S, World

START = 500.0


@pytest.fixture
def said() -> list[str]:
    return []


@pytest.fixture
def world(said: list[str]) -> World:
    return World(load_course("straight"), START, say=said.append)


def _run(
    world: World, start: float, seconds: float, command: Callable[[], tuple[float, float]] | None
) -> float:
    """Advance by 25 ms, with a command (angle, acceleration) before each; return the end."""
    for step in range(round(seconds / 0.025)):
        now = start + 0.025 * step
        if command is not None:
            world.offer_command(now, *command())
        world.advance(now)
    return start + seconds


def test_is_held_until_commands_come(world: World) -> None:
    now = _run(world, START, 2.0, None)
    assert (world.mode, world.gate.state) == (Mode.STOP, GateState.WAITING)
    assert world.plant.speed == 0.0
    assert world.status(now)["time_s"] == 0.0
    assert world.status(now)["command_age_s"] is None


def test_engages_and_drives(world: World, said: list[str]) -> None:
    now = _run(world, START, 3.0, lambda: (0.0, 1.0))
    assert (world.mode, world.gate.state) == (Mode.AUTONOMOUS, GateState.DRIVING)
    assert said == ["commands come: autonomous mode engaged"]
    assert world.plant.speed == pytest.approx(2.8, abs=0.1)
    status = world.status(now)
    assert status["gate"] == "driving"
    assert status["time_s"] == pytest.approx(3.0, abs=0.05)
    assert status["station"] == pytest.approx(world.plant.x - 10.0)


def test_stays_in_stop_mode_when_it_shall_not_engage() -> None:
    world = World(load_course("straight"), START, engage=False)
    _run(world, START, 3.0, lambda: (0.0, 1.0))
    assert (world.mode, world.gate.state) == (Mode.STOP, GateState.READY)
    assert world.plant.speed == 0.0


def test_a_command_acts_after_the_dead_time_of_the_plant(world: World) -> None:
    """The place on the grid of the publications does not add to it."""
    now = _run(world, START, 2.0, None) + 0.012
    world.offer_command(now, 0.0, 1.0)
    held = world.plant.actuated
    world.advance(now + 0.058)
    assert world.plant.actuated == pytest.approx(held, abs=1e-4)
    world.advance(now + 0.075)
    assert world.plant.actuated > held + 0.1


def test_brakes_in_silence_and_says_so(world: World, said: list[str]) -> None:
    now = _run(world, START, 5.0, lambda: (0.1, 1.0))
    now = _run(world, now, 0.5, None)
    assert world.status(now)["gate"] == "driving"
    assert world.plant.speed > 4.0
    now = _run(world, now, 4.0, None)
    assert world.status(now)["gate"] == "braking"
    assert world.plant.speed == 0.0
    assert world.plant.steering == pytest.approx(0.1, abs=1e-3)
    _run(world, now, 1.0, lambda: (0.0, 1.0))
    assert said[1:] == [
        "commands stopped coming: braking",
        "commands come: autonomous mode engaged",
        "commands are back",
    ]
    assert world.plant.speed > 0.0
    assert world.summary()["silences"] == 1


def test_the_world_stands_still_with_its_process(world: World) -> None:
    """A process that was stopped for two seconds has not driven on blindly."""
    now = _run(world, START, 3.0, lambda: (0.0, 0.5))
    steps = world.plant.steps
    world.advance(now + 2.0)
    assert world.plant.steps - steps == MOST_STEPS
    assert world.stood_still_s == pytest.approx(2.0 - 0.2, abs=0.05)


def test_ends_after_the_last_stop(said: list[str]) -> None:
    world = World(load_course("straight"), START, say=said.append)
    target = world.planner.stop_station
    now = START

    def command() -> tuple[float, float]:
        place = world.planner.place
        if place.station > target - 0.3:
            return 0.0, -2.0
        return 0.0, 2.0 * (place.speed - world.plant.speed) - (0.8 if place.station > 300 else 0.0)

    while not world.has_ended(now):
        assert now < START + 120.0
        now = _run(world, now, 0.5, command)
    summary = world.summary()
    assert summary["finished"]
    assert summary["on_course"]
    assert summary["stopped_in_place"]
    assert "stopped" in said[-1]
    assert not world.has_ended(world._finished_at + 0.5 * SETTLE_S)  # type: ignore[operator]


def test_lap_after_lap() -> None:
    world = World(load_course("straight"), START, repeat=True)
    assert world.planner.repeat


def test_an_operator_disengages_and_engages(world: World, said: list[str]) -> None:
    now = _run(world, START, 2.0, lambda: (0.0, 1.0))
    world.disengage()
    now = _run(world, now, 2.0, lambda: (0.0, 1.0))
    assert (world.mode, world.gate.state) == (Mode.STOP, GateState.READY)
    assert world.plant.speed == 0.0
    world.engage()
    _run(world, now, 1.0, lambda: (0.0, 1.0))
    assert (world.mode, world.gate.state) == (Mode.AUTONOMOUS, GateState.DRIVING)
    assert said == ["commands come: autonomous mode engaged"] * 2


def test_silence_in_manual_mode_is_no_alarm(world: World, said: list[str]) -> None:
    now = _run(world, START, 1.0, lambda: (0.0, 1.0))
    world.disengage()
    _run(world, now, 2.0, None)
    assert world.gate.state is GateState.BRAKING
    assert said == ["commands come: autonomous mode engaged"]


def test_stays_engaged_in_a_silence_when_it_is_asked_to(world: World) -> None:
    now = _run(world, START, 1.0, lambda: (0.0, 1.0))
    world.stay_engaged()
    now = _run(world, now, 2.0, None)
    assert (world.mode, world.gate.state) == (Mode.AUTONOMOUS, GateState.BRAKING)
    _run(world, now, 0.2, lambda: (0.0, 1.0))
    assert world.gate.state is GateState.DRIVING


def test_status_tells_the_slope() -> None:
    world = World(load_course("hill"), START)
    world.plant.x += 50.0
    now = _run(world, START, 0.5, None)
    assert world.status(now)["slope"] == pytest.approx(0.08, abs=0.005)
