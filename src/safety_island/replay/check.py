# SPDX-License-Identifier: Apache-2.0
"""Whether the arrays of a file make a recorded run; what is wrong is a ValueError that says it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

Table = npt.NDArray[np.float64]
Whole = npt.NDArray[np.int64]

LATEST = 2.0**31
"""Times [s] lie before this: a stamp counts seconds in 32 bits."""

POINT_COLUMNS = 13
"""Columns of a trajectory point in a recording; in a message those from 7 on are float32."""

TIME_COLUMN = POINT_COLUMNS
"""A further column that a recording may have: time_from_start [s]."""

_LARGEST_WHOLE = 2.0**53


def numbers(values: npt.NDArray[Any], name: str, dimensions: int) -> Table:
    """Return an array as float64; it must hold numbers and have that many dimensions."""
    if values.dtype.kind not in "biuf":
        raise ValueError(f"{name} holds {values.dtype}, expected numbers")
    if values.ndim != dimensions:
        raise ValueError(f"{name} has {values.ndim} dimensions, expected {dimensions}")
    return values.astype(np.float64)


def whole_numbers(values: npt.NDArray[Any], name: str, dimensions: int = 1) -> Whole:
    """Return an array as int64; each number must be whole."""
    table = numbers(values, name, dimensions)
    wrong = table[~((np.abs(table) < _LARGEST_WHOLE) & (table == np.floor(table)))]
    if wrong.size:
        raise ValueError(f"{name} holds {wrong.flat[0]:g}, expected whole numbers")
    return table.astype(np.int64)


def as_message(values: Table) -> Table:
    """Round values to what a float32 of a message holds; too large a one becomes infinite."""
    with np.errstate(over="ignore", invalid="ignore"):  # invalid: a signalling NaN
        return values.astype(np.float32).astype(np.float64)


def columns(table: npt.NDArray[Any], names: npt.NDArray[Any], what: str) -> dict[str, Table]:
    """Return the columns of a (ticks, n) table by name."""
    values = numbers(table, what, 2)
    if names.ndim != 1 or values.shape[1] != len(names):
        raise ValueError(f"{what} has the shape {values.shape}, which does not fit its names")
    return {str(name): values[:, i] for i, name in enumerate(names)}


def require(found: Mapping[str, Table], names: Sequence[str], what: str) -> None:
    """Each of the names must be there."""
    missing = [name for name in names if name not in found]
    if missing:
        raise ValueError(f"{what} lacks the column '{missing[0]}'")


def check_times(times: Table, name: str) -> None:
    """Times [s] must be what a stamp can hold."""
    wrong = times[~((times >= 0.0) & (times < LATEST))]
    if wrong.size:
        raise ValueError(f"{name} holds {wrong[0]:g}, expected seconds from 0 to {LATEST:g}")


def check_state(state: Mapping[str, Table]) -> None:
    """Inputs must be what a message can hold; NaN and infinity are."""
    check_times(state["t"], "state column 't'")
    if (np.diff(state["t"]) < 0.0).any():
        raise ValueError("state column 't' runs backward")
    modes = whole_numbers(state["mode"], "state column 'mode'")
    if ((modes < 0) | (modes > 255)).any():
        raise ValueError("state column 'mode' reaches beyond 0 to 255")


def check_paths(points: Table, offsets: Whole) -> None:
    """The offsets must divide the points, and the points must have their columns."""
    if len(offsets) == 0 or (np.diff(offsets) < 0).any() or offsets[0] < 0:
        raise ValueError("path_offsets does not ascend from 0")
    if offsets[-1] > len(points):
        raise ValueError(f"path_offsets ends at {offsets[-1]}, path_points at {len(points)}")
    if points.shape[1] > TIME_COLUMN:
        times = points[:, TIME_COLUMN]
        wrong = times[~(np.abs(times) < LATEST)]
        if wrong.size:
            raise ValueError(f"path_points holds the time {wrong[0]:g}, expected seconds")
    if points.shape[1] < POINT_COLUMNS:
        raise ValueError(f"path_points has {points.shape[1]} columns, expected {POINT_COLUMNS}")


def check_selection(selection: Table, offsets: Whole) -> None:
    """Every tick's choice must lie within its path; a path of -1 is none yet."""
    if selection.shape[1] != 4:
        raise ValueError(f"traj_select has {selection.shape[1]} columns, expected 4")
    parts = whole_numbers(selection[:, :3], "traj_select", 2)
    chosen = parts[:, 0] >= 0
    check_times(selection[chosen, 3], "traj_select")
    path, first, end = parts[chosen].T
    if (path >= len(offsets) - 1).any():
        raise ValueError(f"traj_select names path {path.max()} of {len(offsets) - 1}")
    if ((first < 0) | (end < first) | (end > (offsets[1:] - offsets[:-1])[path])).any():
        raise ValueError("traj_select reaches beyond its path")
