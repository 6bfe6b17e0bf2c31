# SPDX-License-Identifier: Apache-2.0
"""The Python interface: cheap to import, as the README shows it, and the same as the commands."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import safety_island
from safety_island import (
    Controller,
    Vehicle,
    api,
    drive,
    load_course,
    load_parameters,
    make_course,
)
from safety_island.errors import ConfigurationError, IslandError
from safety_island.sim.plant import Plant

ROOT = Path(__file__).parents[1]


def readme_snippet() -> str:
    """The one Python example of the README."""
    text = (ROOT / "README.md").read_text("utf-8")
    (snippet,) = re.findall(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    return str(snippet)


def test_the_readme_shows_eight_lines_that_run_as_they_stand(tmp_path: Path) -> None:
    snippet = readme_snippet()
    assert len([line for line in snippet.splitlines() if line.strip()]) == 8
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", snippet],
        cwd=tmp_path, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    finished, error = done.stdout.split()[0], float(done.stdout.split()[1])
    assert finished == "True"
    assert 0.0 < error < 0.1


def test_importing_the_package_loads_nothing_else() -> None:
    look = "import sys; before = set(sys.modules); import safety_island; dir(safety_island); "
    look += "print(sorted(m for m in set(sys.modules) - before if 'safety' in m or 'numpy' in m))"
    done = subprocess.run([sys.executable, "-c", look], capture_output=True, text=True, check=True)
    assert done.stdout == "['safety_island']\n"


def test_every_name_is_there_and_no_other() -> None:
    assert set(safety_island.__all__) == {*api.__all__, "__version__"}
    assert set(safety_island.__all__) <= set(dir(safety_island))
    for name in api.__all__:
        assert getattr(safety_island, name) is getattr(api, name)
        assert getattr(api, name).__doc__
    with pytest.raises(AttributeError, match="'nosuch'"):
        _ = safety_island.nosuch


def test_a_drive_is_the_same_every_time_and_given_as_arrays() -> None:
    course = load_course("lane-change")
    first, second = drive(course, limit=12.0), drive(course, limit=12.0)
    assert first.time.shape == first.lateral_error.shape == (80,)
    assert np.array_equal(first.steering_command, second.steering_command)
    assert np.allclose(np.diff(first.time), 0.15)
    assert (first.finished, first.stop_errors) == (False, ())


def test_a_drive_follows_parameters_and_vehicle() -> None:
    course = load_course("straight")
    parameters = load_parameters(ctrl_period=0.03)
    assert len(drive(course, parameters, limit=3.0).time) == 100
    slow = drive(course, vehicle=Vehicle(acceleration_lag=1.5), limit=6.0)
    assert slow.speed[-1] != drive(course, limit=6.0).speed[-1]
    assert len(drive(course, limit=0.0).time) == 0


def test_a_vehicle_of_the_callers_own_is_driven_one_tick_at_a_time() -> None:
    course = make_course([0.0, 20.0, 40.0], [0.0, 1.0, 4.0], v=4.0)
    controller = Controller(course)
    x, y, yaw = controller.start
    plant = Plant(x=x, y=y, yaw=yaw)
    for tick in range(200):
        state = (plant.x, plant.y, plant.yaw, plant.speed, plant.steering)
        command = controller.step(0.15 * tick, *state, acceleration=plant.acceleration)
        if controller.finished:
            break
        assert command is not None
        plant.command(command.steering, command.acceleration)
        plant.advance(30, 0.0)
    assert controller.finished
    assert np.hypot(plant.x - 40.0, plant.y - 4.0) < 0.5


def test_a_step_refuses_what_is_no_measurement() -> None:
    controller = Controller(load_course("straight"))
    place = controller.start
    assert controller.step(1.0, *place, 0.0, 0.0) is not None
    with pytest.raises(IslandError, match="time must go on"):
        controller.step(1.0, *place, 0.0, 0.0)
    for broken in ((np.nan, 0.0), (0.0, np.inf)):
        with pytest.raises(ConfigurationError, match="refused: NOT_FINITE"):
            controller.step(2.0, *place, *broken)
    assert controller.step(2.0, *place, 0.0, 0.0) is not None


def test_parameters_are_checked() -> None:
    assert load_parameters(base="firmware") != load_parameters()
    with pytest.raises(IslandError, match="nosuch"):
        load_parameters(nosuch=1)
