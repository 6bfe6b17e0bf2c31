# SPDX-License-Identifier: Apache-2.0
"""Small recorded runs for tests, and copies of them with something changed."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from tests.golden.harness import DATA

RUN = "curve/ctrl0.15_unconstraint_fast"
UNPOLISHED = "traj_jump/ctrl0.15_osqp"
TICKS = 12
Arrays = dict[str, Any]


def arrays_of(name: str = RUN, ticks: int = TICKS) -> Arrays:
    """The arrays of the first ticks of a golden run."""
    with np.load(DATA / f"{name}.npz") as data:
        arrays = {key: data[key] for key in data.files}
    for key in ("state", "deliver_mask", "traj_select", "output"):
        arrays[key] = arrays[key][:ticks].copy()
    return arrays


def write(path: Path, **changes: Any) -> Path:
    """Write such a run to ``path``; an array of None is left out."""
    arrays = {key: value for key, value in (arrays_of() | changes).items() if value is not None}
    path.parent.mkdir(parents=True, exist_ok=True)
    np.savez(path, **arrays)
    return path


def changed(key: str, column: int, tick: int, value: float) -> Arrays:
    """One number of a table replaced."""
    table = arrays_of()[key]
    table[tick, column] = value
    return {key: table}


def output_column(name: str) -> int:
    """Where a column stands in the output."""
    return list(arrays_of()["output_cols"]).index(name)


def guarded(**limits: object) -> Arrays:
    """The run's parameters with other limits of the guard."""
    values = json.loads(str(arrays_of()["params_json"]))
    values |= {f"guard.{name}": value for name, value in limits.items()}
    return {"params_json": np.array(json.dumps(values))}
