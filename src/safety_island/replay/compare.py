# SPDX-License-Identifier: Apache-2.0
"""How close a replay came to a recording, and whether that is close enough.

Tolerances: a run of ``unconstraint_fast`` must agree in every tick. OSQP itself was inexact in the
ticks that it could not polish, so those are held to what it was off by; a tick after such a one
starts from another memory, and is held to the same until both agree again.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from safety_island.replay.check import Table
from safety_island.replay.guard_acts import GuardActs, guard_acts
from safety_island.replay.recording import CONTRACT_COLUMNS, Recording

COMMAND_COLUMNS = CONTRACT_COLUMNS[2:]
ANGLE, RATE = COMMAND_COLUMNS[:2]
CONVERGED = "is_steer_converged"

EXACT = {ANGLE: 1e-6, RATE: 1e-5, "velocity": 1e-5, "acceleration": 1e-5}
POLISHED = EXACT | {ANGLE: 1e-5, RATE: 1e-4}
UNPOLISHED = EXACT | {ANGLE: 4e-2, RATE: float("inf")}


class Exceeding(NamedTuple):
    """The first tick that is not close enough."""

    tick: int
    t: float
    column: str
    recorded: float
    replayed: float
    tolerance: float

    def __str__(self) -> str:
        """One line for a person."""
        return (
            f"tick {self.tick} (t = {self.t:.3f} s): {self.column} is {self.replayed:.9g}, "
            f"recorded {self.recorded:.9g}, tolerance {self.tolerance:g}"
        )


@dataclass(frozen=True)
class Verdict:
    """What a replay amounts to; ``greatest`` is the greatest difference of each column."""

    name: str
    ticks: int
    greatest: dict[str, float]
    exceeding: Exceeding | None
    guard: GuardActs
    loose_ticks: int = 0
    """Ticks that were held to the tolerance of an unpolished solution."""

    @property
    def passed(self) -> bool:
        """Whether every tick was close enough."""
        return self.exceeding is None


def judge(run: Recording, replayed: dict[str, Table]) -> Verdict:
    """Compare what was ``replayed`` (the columns of ``feed.replay``) with the recording."""
    differences = {name: _difference(run.output[name], replayed[name]) for name in CONTRACT_COLUMNS}
    polished = _polished(run)
    exceeding = None
    inexact = False
    loose_ticks = 0
    for tick in range(run.ticks):
        row = {name: float(differences[name][tick]) for name in COMMAND_COLUMNS}
        close = row[ANGLE] <= POLISHED[ANGLE] and row[RATE] <= POLISHED[RATE]
        loose = polished is not None and (not polished[tick] or (inexact and not close))
        inexact = loose and not close
        loose_ticks += loose
        tolerance = UNPOLISHED if loose else (EXACT if polished is None else POLISHED)
        exceeding = exceeding or _first(run, replayed, tick, row, tolerance, loose)
    greatest = {name: float(np.max(values)) for name, values in differences.items()}
    acts = guard_acts(replayed)
    return Verdict(run.name, run.ticks, greatest, exceeding, acts, loose_ticks)


def _polished(run: Recording) -> npt.NDArray[np.bool_] | None:
    """Whether OSQP polished each tick's solution; None when the run is no OSQP run."""
    if run.solver != "osqp" or "qp_polish" not in run.output:
        return None
    solved = run.output["mpc_solved"] == 1 if "mpc_solved" in run.output else True
    return np.asarray((run.output["qp_polish"] == 1) | ~np.asarray(solved, dtype=bool))


def _difference(recorded: Table, replayed: Table) -> Table:
    """Absolute difference; two NaN are equal, one NaN or infinity is infinitely far."""
    both = np.isnan(recorded) & np.isnan(replayed)
    with np.errstate(invalid="ignore", over="ignore"):  # a file may say infinity
        difference = np.abs(np.where(both, 0.0, recorded - replayed))
    return np.where(np.isnan(difference), np.inf, difference)


def _first(
    run: Recording,
    replayed: dict[str, Table],
    tick: int,
    row: dict[str, float],
    tolerance: dict[str, float],
    loose: bool,
) -> Exceeding | None:
    """The first column, left to right, in which a tick is not close enough."""
    allowed = {"published": 0.0} | tolerance
    if not loose and CONVERGED in run.output and run.output["published"][tick] == 1:
        allowed[CONVERGED] = 0.0
    for name, limit in allowed.items():
        recorded = float(run.output[name][tick])
        ours = float(replayed[name][tick])
        difference = row[name] if name in row else abs(recorded - ours)
        if not difference <= limit:
            return Exceeding(tick, float(run.output["t"][tick]), name, recorded, ours, limit)
    return None
