# SPDX-License-Identifier: Apache-2.0
"""``island replay``: recorded runs through the real node, compared with what they hold."""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from safety_island.cli.options import add_json
from safety_island.cli.parser import teach
from safety_island.cli.progress import prepare_kernels
from safety_island.cli.tell import tell
from safety_island.errors import ConfigurationError
from safety_island.extras import is_installed, require
from safety_island.guard import Verdict as GuardVerdict

if TYPE_CHECKING:
    from safety_island.replay.compare import Verdict
    from safety_island.replay.guard_acts import GuardActs

PURPOSE = """
Feed recorded runs of Autoware's C++ controllers through the real controller node on virtual time,
and compare the commands that it publishes, behind the guard, with what was recorded. For each run:
the number of ticks, the greatest difference in each column, how many commands the guard changed or
refused, the first tick that is not close enough, pass or fail. The exit code is 1 when a run fails.
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    teach(
        parser,
        PURPOSE,
        ("island replay tests/golden/data", "every run below a folder"),
        ("island replay s_curve/ctrl0.15_osqp.npz --csv out", "one run, its ticks as CSV"),
        ("island replay tests/golden/data --json", "for a script"),
    )
    parser.add_argument(
        "paths", nargs="+", type=Path, metavar="FILE_OR_FOLDER", help="recorded runs (.npz)"
    )
    parser.add_argument(
        "--csv",
        type=Path,
        metavar="DIR",
        help="write DIR/<scenario>__<run>.csv: every published command, and what the guard changed",
    )
    parser.add_argument(
        "--solver",
        choices=("unconstraint_fast", "osqp", "daqp"),
        help="solve with this instead of the run's own solver",
    )
    add_json(parser, "the verdicts")


def execute(arguments: argparse.Namespace) -> int:
    """Replay and judge every run."""
    from safety_island.replay.recording import find

    paths = find(arguments.paths)
    _require_solver(paths, arguments.solver)
    if arguments.csv is not None:
        _make_folder(arguments.csv)
    prepare_kernels()
    verdicts = []
    for index, path in enumerate(paths):
        verdict = _replay(path, arguments, f"{index + 1} of {len(paths)}")
        verdicts.append((path, verdict))
        if not arguments.json:
            print(_line(verdict), flush=True)
    passed = sum(verdict.passed for _, verdict in verdicts)
    if arguments.json:
        print(json.dumps(_as_json(verdicts), indent=2, allow_nan=False))
    else:
        print(f"{len(verdicts)} runs: {passed} passed, {len(verdicts) - passed} failed")
    return 0 if passed == len(verdicts) else 1


def _make_folder(folder: Path) -> None:
    """Make the folder for the ticks, and say so; the one around it must be there."""
    if folder.exists():
        return
    try:
        folder.mkdir()
    except OSError as error:
        raise ConfigurationError(
            f"--csv {folder}: the folder cannot be made: {error.strerror}"
        ) from None
    tell(f"island: made the folder {folder}")


def _require_solver(paths: Sequence[Path], solver: str | None) -> None:
    """Raise ConfigurationError now when a run needs OSQP and it is not there, not in the middle."""
    from safety_island.replay.recording import load

    if not is_installed("osqp") and "osqp" in (solver or load(path).solver for path in paths):
        require("osqp", "a run by the solver osqp", ", or replay with --solver daqp")


def _replay(path: Path, arguments: argparse.Namespace, place: str) -> Verdict:
    from safety_island.cli.progress import tick_progress
    from safety_island.replay.compare import judge
    from safety_island.replay.feed import replay
    from safety_island.replay.recording import load
    from safety_island.replay.write import write_csv

    run = load(path)
    with tick_progress(f"{place}: {run.name}", run.ticks, sys.stderr) as report:
        replayed = replay(run, arguments.solver, report)
    if arguments.csv is not None:
        write_csv(arguments.csv, run, replayed)
    return judge(run, replayed)


def _line(verdict: Verdict) -> str:
    """One run for a person."""
    differences = "  ".join(f"{name} {value:.1e}" for name, value in verdict.greatest.items())
    loose = f" ({verdict.loose_ticks} held loosely)" if verdict.loose_ticks else ""
    word = "pass" if verdict.passed else "FAIL"
    text = f"{word}  {verdict.name}  {verdict.ticks} ticks{loose}\n      {differences}"
    text += f"  {_guard(verdict)}"
    if verdict.exceeding is not None:
        act = verdict.guard.at(verdict.exceeding.tick)
        text += f"\n      first beyond tolerance: {verdict.exceeding}{f'; {act}' if act else ''}"
    return text


def _guard(verdict: Verdict) -> str:
    """What the guard did, for a person."""
    acts = verdict.guard
    changed, refused = (acts.count(kind) for kind in (GuardVerdict.CLAMPED, GuardVerdict.REFUSED))
    text = f"guard: {changed} of {acts.commands} commands changed, {refused} refused"
    if not acts.acts:
        return text
    limits = ", ".join(f"{name} {count}" for name, count in acts.limits().items())
    return f"{text} ({limits}), first in tick {acts.acts[0].tick}"


def _as_json(verdicts: list[tuple[Path, Verdict]]) -> dict[str, Any]:
    runs = [
        {
            "name": verdict.name,
            "file": str(path),
            "ticks": verdict.ticks,
            "loose_ticks": verdict.loose_ticks,
            "greatest_difference": _as_numbers(verdict.greatest),
            "guard": _guard_as_json(verdict.guard),
            "first_exceeding": verdict.exceeding and _as_numbers(verdict.exceeding._asdict()),
            "passed": verdict.passed,
        }
        for path, verdict in verdicts
    ]
    return {"runs": runs, "passed": all(run["passed"] for run in runs)}


def _guard_as_json(acts: GuardActs) -> dict[str, Any]:
    return {
        "commands": acts.commands,
        "changed": acts.count(GuardVerdict.CLAMPED),
        "refused": acts.count(GuardVerdict.REFUSED),
        "limits": acts.limits(),
        "first_tick": acts.acts[0].tick if acts.acts else None,
    }


def _as_numbers(values: dict[str, Any]) -> dict[str, Any]:
    """JSON has no NaN and no infinity: null, as where only one side published."""
    return {
        name: None if isinstance(value, float) and not math.isfinite(value) else value
        for name, value in values.items()
    }
