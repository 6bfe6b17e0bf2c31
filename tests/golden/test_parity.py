# SPDX-License-Identifier: Apache-2.0
"""Every recorded run of the C++ firmware through the real controller node, compiled and plain."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from safety_island.kernel.kernel import JIT
from safety_island.replay.check import Table
from safety_island.replay.compare import judge
from safety_island.replay.feed import Replay
from safety_island.replay.guard_acts import GUARD_COLUMNS, LIMITS, VERDICT
from safety_island.replay.recording import CONTRACT_COLUMNS, Recording, load
from tests.golden.harness import name_of, recorded, run_paths

Mask = npt.NDArray[np.bool_]
ROOT = Path(__file__).parents[2]
CONVERGED = "is_steer_converged"

OF_INPUTS = {
    "lateral_error": 1e-9,
    "yaw_error": 1e-9,
    "nearest_idx": 0.0,
    "prediction_dt": 1e-9,
    "is_forward_shift": 0.0,
    "mpc_history_filled": 0.0,
}
"""Columns of the trace that no solver has a part in, and how far each may be off."""

OF_SOLUTION = ("u0", "u1", "u2", "u3", "u4", "raw_steer_cmd_prev", "raw_steer_cmd_pprev")
SAME_SOLUTION = {"unconstraint_fast": 1e-6, "osqp": 1e-5}
"""Distance of two solutions [rad] of the same problem; OSQP's where it polished."""

SHORT = (
    "bad_trajectory/ctrl0.15_unconstraint_fast",
    "curve/ctrl0.03_osqp_u040",
    "figure8_global/ctrl0.15_unconstraint_fast_thr",
    "lane_change/ctrl0.03_osqp_dynamics",
    "lane_change/ctrl0.15_unconstraint_fast_dynamics",
    "lane_change/ctrl0.03_osqp_smooth",
    "lane_change/ctrl0.15_unconstraint_fast_smooth",
    "manual_mode/ctrl0.15_osqp",
    "reverse/ctrl0.15_unconstraint_fast_alt",
    "reverse/ctrl0.15_unconstraint_fast_nodelay",
    "s_curve/ctrl0.03_osqp_alt",
    "startup/ctrl0.15_unconstraint_fast",
    "straight_offset/ctrl0.03_osqp_nodelay",
    "u_turn/ctrl0.15_osqp",
)
"""One run of each variant and solver; its first SHORT_TICKS are played without compilation too."""

SHORT_TICKS = 15


def cut(run: Recording, ticks: int) -> Recording:
    """Return the first ticks of a run."""
    return replace(
        run,
        state={name: column[:ticks] for name, column in run.state.items()},
        output={name: column[:ticks] for name, column in run.output.items()},
        deliver_mask=run.deliver_mask[:ticks],
        traj_select=run.traj_select[:ticks],
    )


def play(run: Recording) -> dict[str, Table]:
    """Replay a run; return what was published, the guard's columns and the trace's.

    NaN stands where nothing came out.
    """
    player = Replay(run)
    traced = (*OF_INPUTS, *OF_SOLUTION[5:], "predicted_steer", CONVERGED)
    names = (*CONTRACT_COLUMNS[2:], *traced, *OF_SOLUTION[:5])
    columns = {name: np.full(run.ticks, np.nan) for name in (*names, *GUARD_COLUMNS)}
    columns |= {"t": run.state["t"], "published": np.zeros(run.ticks)}
    for tick in range(run.ticks):
        command, trace, check = player.tick(tick), player.follower.trace, player.node.check
        columns[VERDICT][tick], columns[LIMITS][tick] = check.verdict, check.limits
        if command is not None:
            columns["published"][tick] = 1.0
            values = [float(getattr(command, name)) for name in CONTRACT_COLUMNS[2:]]
            values += [float(trace[name][0]) for name in traced] + list(trace["u"][0, :5])
            for name, value in zip(names, values, strict=True):
                columns[name][tick] = value
    return columns


def check_trace(run: Recording, columns: dict[str, Table]) -> None:
    """Compare what the controller was about: errors, prediction, solution and memories."""
    published = run.output["published"] == 1
    tolerances = dict(OF_INPUTS)
    if run.overrides.get("use_steer_prediction"):
        tolerances["predicted_steer"] = 1e-6
    for name, tolerance in tolerances.items():
        check_column(run, columns, name, published, tolerance)
    comparable = published & (run.output["mpc_solved"] == 1)
    if run.solver == "osqp":
        comparable &= (run.output["qp_polish"] == 1) & started_alike(run, columns)
    for name in OF_SOLUTION:
        check_column(run, columns, name, comparable, SAME_SOLUTION[run.solver])


def started_alike(run: Recording, columns: dict[str, Table]) -> Mask:
    """Whether both solved a tick from the same memory: unpolished ticks leave another one."""
    name = "raw_steer_cmd_prev"
    apart = np.abs(columns[name] - run.output[name]) > 1e-6
    return np.asarray(~np.concatenate([[False], apart[:-1]]) & ~apart)


def check_column(
    run: Recording, columns: dict[str, Table], name: str, where: Mask, tolerance: float
) -> None:
    """Fail with the first tick of a column that is off."""
    far = where & ~(np.abs(columns[name] - run.output[name]) <= tolerance)
    ticks = np.flatnonzero(far)
    assert len(ticks) == 0, (
        f"{run.name} tick {ticks[0]}: {name} is {columns[name][ticks[0]]!r}, "
        f"recorded {run.output[name][ticks[0]]!r}"
    )


@pytest.mark.skipif(not JIT, reason="takes minutes in plain Python; the short runs do that")
@pytest.mark.parametrize("path", run_paths(), ids=name_of)
def test_a_run_is_the_firmwares(path: Path) -> None:
    run = load(path)
    columns = play(run)
    verdict = judge(run, columns)
    assert verdict.passed, str(verdict.exceeding)
    assert not verdict.guard.acts, str(verdict.guard.acts[0])
    if "mpc_solved" in run.output:  # the benchmark runs hold the contract's columns only
        check_trace(run, columns)


def play_short(path: str) -> None:
    """Replay the short runs and write their columns to ``path``, as ``run:column``."""
    flat: dict[str, Any] = {}
    for name in SHORT:
        columns = play(cut(recorded(name), SHORT_TICKS))
        flat |= {f"{name}:{key}".replace("/", "|"): values for key, values in columns.items()}
    np.savez(path, **flat)


def played_plainly(folder: Path) -> dict[str, dict[str, Table]]:
    """The columns of the short runs, replayed by a process that compiles nothing."""
    code = "import sys; from tests.golden import test_parity as t; t.play_short(sys.argv[1])"
    result = subprocess.run(
        [sys.executable, "-c", code, str(folder / "plain.npz")],
        cwd=ROOT,
        env=os.environ | {"SAFETY_ISLAND_JIT": "0", "PYTHONPATH": f"{ROOT / 'src'}:{ROOT}"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 0, result.stderr[-2000:]
    assert result.stderr == "", "plain Python warned of something"
    columns: dict[str, dict[str, Table]] = {name: {} for name in SHORT}
    with np.load(folder / "plain.npz") as data:
        for key in data.files:
            name, _, column = key.replace("|", "/").partition(":")
            columns[name][column] = data[key]
    return columns


@pytest.mark.timeout(600)  # some 20 s on an idle machine
def test_plain_python_is_the_firmware_too_and_gives_the_same_bits(tmp_path: Path) -> None:
    """One short run of each kind: the same source, compiled or not."""
    for name, plain in played_plainly(tmp_path).items():
        run = cut(recorded(name), SHORT_TICKS)
        verdict = judge(run, plain)
        assert verdict.passed, f"{name}: {verdict.exceeding}"
        check_trace(run, plain)
        for column, values in play(run).items() if JIT else ():
            assert values.tobytes() == plain[column].tobytes(), f"{name}: {column}"
