# SPDX-License-Identifier: Apache-2.0
"""The longitudinal controller alone against every recorded run of the C++ firmware."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from safety_island.control.follower import TrajectoryFollower
from safety_island.control.records import COMMAND, TRACE
from safety_island.replay.recording import Recording, load
from tests.golden.harness import name_of, parameters_of, played, recorded, run_paths

TRACED = [
    "lon_state",
    "stop_dist",
    "target_vel",
    "nearest_vel",
    "target_acc",
    "pred_vel",
    "slope_angle",
    "err_vel_filtered",
    "pid_p",
    "pid_i",
    "pid_d",
    "ff_scale",
    "acc_ff",
    "acc_pid_applied",
    "acc_acc_limited",
    "acc_jerk_limited",
    "acc_fb_applied",
    "acc_slope_applied",
    "trans_dev",
    "rot_dev",
    "prev_raw_acc",
    "prev_raw_vel",
    "prev_acc",
]
"""Columns of the recordings that the trace holds under the same name."""

COMMANDED = ("velocity", "acceleration")

TOLERANCE = 1e-9
"""Of a double value; the contract asks for 1e-5."""

TOLERANCE_COMMAND = 1e-7
"""Of a published ``float32``, which the recording holds rounded to 8 decimals."""

Columns = dict[str, npt.NDArray[np.float64]]


def replay(run: Recording) -> Columns:
    """Replay a run with the recorded convergence of the previous tick."""
    follower = TrajectoryFollower(parameters_of(run))
    converged = run.output.get("is_steer_converged", np.zeros(run.ticks))  # not read in motion
    traces, commands = np.zeros(run.ticks, TRACE), np.zeros(run.ticks, COMMAND)
    for tick, now in played(run, follower):
        follower.run_longitudinal(now)
        traces[tick], commands[tick] = follower.trace[0], follower.command[0]
        follower.trace[0].is_steer_converged = bool(converged[tick])
        follower.sync()
    return {name: traces[name].astype(float) for name in TRACED} | {
        name: commands[name].astype(float) for name in COMMANDED
    }


def difference(run: Recording, result: Columns) -> str:
    """The first tick that differs, with every column that does; empty when none does."""
    published = run.output["published"] > 0
    first = run.ticks
    lines: list[str] = []
    for name in (name for name in (*TRACED, *COMMANDED) if name in run.output):
        tolerance = TOLERANCE_COMMAND if name in COMMANDED else TOLERANCE
        same = np.isclose(result[name], run.output[name], rtol=0, atol=tolerance, equal_nan=True)
        wrong = np.flatnonzero(published & ~same)
        if len(wrong) and wrong[0] <= first:
            lines = lines if wrong[0] == first else []
            first = int(wrong[0])
            lines.append(f"{name}: {result[name][first]!r}, recorded {run.output[name][first]!r}")
    return f"{run.name} tick {first}: " + "; ".join(lines) if lines else ""


@pytest.mark.parametrize("path", run_paths(), ids=name_of)
def test_every_column_is_the_firmwares(path: Path) -> None:
    run = load(path)
    assert difference(run, replay(run)) == ""


def test_a_difference_is_told_with_its_first_tick_and_columns() -> None:
    run = recorded("curve/ctrl0.15_unconstraint_fast")
    result = replay(run)
    result["pid_p"][7] += 1e-3
    result["prev_acc"][[7, 9]] += 1e-3
    told = difference(run, result)
    assert told.startswith("curve/ctrl0.15_unconstraint_fast tick 7: pid_p: ")
    assert "prev_acc: " in told
