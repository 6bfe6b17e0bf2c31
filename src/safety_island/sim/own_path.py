# SPDX-License-Identifier: Apache-2.0
"""A course from a path of the user's own: points from arrays, or from a CSV or YAML file."""

from __future__ import annotations

import csv
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path as FilePath
from typing import Any

import numpy as np
import numpy.typing as npt
import yaml

from safety_island.errors import ConfigurationError
from safety_island.sim.courses import LEAD_IN, Course, make_legs
from safety_island.sim.shapes import SPACING, Floats, Path
from safety_island.text_file import UnreadableError, read_text

COLUMNS = ("x", "y", "yaw", "v")
"""Columns of a path file, in this order where it has no header; yaw and v may be left out."""

DEFAULT_SPEED = 5.0
"""Highest speed [m/s] of a path that has none."""

SHORTEST, LONGEST = 5.0, 50_000.0
"""Length of a path [m]: room to drive off and to stop; memory for all of its points."""

FASTEST = 60.0
"""[m/s]"""

FARTHEST = 1e7
"""Largest coordinate [m]: beyond it, single points lie a millimetre apart from their neighbours."""

MAX_FILE = 32 << 20
"""[B] of a path file."""

_SAME_PLACE = 1e-3
_FINE = 10
"""Points in which each SPACING of the user's path is measured."""

Numbers = npt.ArrayLike


def make_course(
    x: Numbers,
    y: Numbers,
    yaw: Numbers | None = None,
    v: Numbers = DEFAULT_SPEED,
    *,
    name: str = "own path",
) -> Course:
    """Return the course along points ``x``, ``y`` [m] in the order of driving.

    ``yaw`` [rad] is the direction at each point (None: that of the points); a smooth curve joins
    them. ``v`` [m/s] is the highest speed, one for all or one for each point: the vehicle drives
    slower where a bend or a stop asks for it, stops at the last point, and for a moment at each
    point with speed zero in between. Raises ConfigurationError with ``name`` for what is no path.
    """
    points = _checked(name, x, y, yaw, v)
    chords = np.append(0.0, np.cumsum(np.hypot(np.diff(points["x"]), np.diff(points["y"]))))
    if not SHORTEST <= chords[-1] <= LONGEST:
        raise ConfigurationError(
            f"{name}: the path is {chords[-1]:.2f} m long, expected {SHORTEST:g} to {LONGEST:g} m"
        )
    directions = _directions(name, points, chords)
    return Course(name, "a path of the user's own", _legs(points, chords, directions))


def read_course(file: str | FilePath) -> Course:
    """Return the course of a path file: CSV, or YAML for ``.yaml`` and ``.yml``.

    CSV has the columns ``x,y,yaw,v`` (a header names them in any order; without one they stand in
    this order), YAML a list of numbers for each. Raises ConfigurationError.
    """
    path = FilePath(file)
    try:
        text = read_text(path, MAX_FILE)
    except UnreadableError as error:
        raise ConfigurationError(f"{path}: cannot be read: {error}") from None
    read = _yaml_columns if path.suffix in (".yaml", ".yml") else _csv_columns
    columns = read(str(path), text)
    missing = [name for name in ("x", "y") if name not in columns]
    if missing:
        raise ConfigurationError(f"{path}: no column {missing[0]}, expected {', '.join(COLUMNS)}")
    return make_course(**columns, name=str(path))


def _yaml_columns(name: str, text: str) -> dict[str, Any]:
    try:
        found = yaml.load(text, yaml.BaseLoader)  # texts, lists and maps alone
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        first = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise ConfigurationError(f"{name}: no YAML: {first}") from None
    if not isinstance(found, Mapping):
        raise ConfigurationError(f"{name}: expected a list of numbers for each of x, y, yaw, v")
    for key, values in found.items():
        if key not in COLUMNS:
            shown = str(key)[:40]
            raise ConfigurationError(
                f"{name}: unknown key '{shown}', expected {', '.join(COLUMNS)}"
            )
        if not all(isinstance(v, str) for v in (values if isinstance(values, list) else [values])):
            raise ConfigurationError(f"{name}: {key} is not a list of numbers")
    return dict(found)


def _csv_columns(name: str, text: str) -> dict[str, Any]:
    lines = enumerate(text.splitlines(), start=1)
    kept = [(number, line) for number, line in lines if line.strip() and line.lstrip()[0] != "#"]
    try:
        rows = [[cell.strip() for cell in row] for row in csv.reader(line for _, line in kept)]
    except csv.Error as error:
        raise ConfigurationError(f"{name}: no CSV: {error}") from None
    head: Sequence[str] = COLUMNS[: len(rows[0])] if rows else ()
    if rows and not _is_number(rows[0][0]):
        head = rows.pop(0)
        kept.pop(0)
        unknown = [cell for cell in head if cell not in COLUMNS]
        if unknown or len(set(head)) < len(head):
            shown = f"unknown column '{unknown[0][:40]}'" if unknown else "a column twice"
            raise ConfigurationError(f"{name}: {shown}, expected {', '.join(COLUMNS)}")
    for (number, _), row in zip(kept, rows, strict=True):
        wrong = next((cell for cell in row if not _is_number(cell)), None)
        if wrong is not None:
            raise ConfigurationError(f"{name}:{number}: '{wrong[:40]}' is not a number")
        if len(row) != len(head):
            raise ConfigurationError(
                f"{name}:{number}: {len(row)} values, expected {len(head)} ({', '.join(head)})"
            )
    return {key: [float(row[i]) for row in rows] for i, key in enumerate(head)}


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _checked(
    name: str, x: Numbers, y: Numbers, yaw: Numbers | None, v: Numbers
) -> dict[str, Floats]:
    """Return the columns with one value for each place, points on top of each other left out."""
    columns = {"x": _column(name, "x", x, FARTHEST), "y": _column(name, "y", y, FARTHEST)}
    if yaw is not None:
        columns["yaw"] = _column(name, "yaw", yaw, 1e6)
    speed = _column(name, "v", v, FASTEST)
    count = columns["x"].size
    if count < 2:
        raise ConfigurationError(f"{name}: x has {count} values, expected two points or more")
    columns["v"] = np.full(count, speed.item()) if speed.ndim == 0 else speed
    for key, column in columns.items():
        if column.ndim != 1 or column.size != count:
            raise ConfigurationError(f"{name}: {key} has {column.size} values, and x has {count}")
    if columns["v"].min() < 0.0:
        raise ConfigurationError(f"{name}: v is {columns['v'].min():g}; reversing is not supported")
    if not (columns["v"] > 0.0).any():
        raise ConfigurationError(f"{name}: v is nowhere above zero, so nothing would drive")
    moved = np.hypot(np.diff(columns["x"]), np.diff(columns["y"])) > _SAME_PLACE
    keep = np.append(True, moved)
    return {key: column[keep] for key, column in columns.items()}


def _column(name: str, key: str, values: Numbers, most: float) -> Floats:
    try:
        column = np.asarray(values, np.float64)
    except (TypeError, ValueError, OverflowError):
        raise ConfigurationError(f"{name}: {key} is not a list of numbers") from None
    wrong = np.flatnonzero(~(np.abs(column) <= most))
    if wrong.size:
        value = column.flat[wrong[0]]
        raise ConfigurationError(
            f"{name}: {key} of point {wrong[0]} is {value:g}, expected at most {most:g}"
        )
    return column


def _directions(name: str, points: Mapping[str, Floats], chords: Floats) -> Floats:
    """Return unit vectors, shape (n, 2), along the path."""
    steps = np.column_stack((np.diff(points["x"]), np.diff(points["y"])))
    back = np.flatnonzero((steps[1:] * steps[:-1]).sum(1) < 0.0)
    if back.size:
        raise ConfigurationError(
            f"{name}: the path turns back at point {back[0] + 1}; reversing is not supported"
        )
    if "yaw" not in points:
        along = np.column_stack([np.gradient(points[key], chords) for key in ("x", "y")])
        directions: Floats = along / np.hypot(*along.T)[:, None]
        return directions
    directions = np.column_stack((np.cos(points["yaw"]), np.sin(points["yaw"])))
    against = np.flatnonzero((directions[:-1] * steps).sum(1) <= 0.0)
    if against.size:
        raise ConfigurationError(
            f"{name}: yaw of point {against[0]} points away from the next one; yaw is in radians"
        )
    return directions


def _legs(points: Mapping[str, Floats], chords: Floats, directions: Floats) -> Any:
    """Sample the curve through the points every SPACING, from its end back to the lead-in."""
    first, back = directions[0], LEAD_IN + SPACING
    count = max(int(chords[-1] / SPACING) * _FINE, len(chords))
    at = np.linspace(0.0, chords[-1], count)
    curve = _hermite(points, chords, directions)
    x, y = (
        np.append(points[key][0] - back * first[i], curve(i, at))
        for i, key in enumerate(("x", "y"))
    )
    arc = np.append(0.0, np.cumsum(np.hypot(np.diff(x), np.diff(y)))) - back
    places = arc[-1] - SPACING * np.arange(int((arc[-1] + LEAD_IN) / SPACING), -1, -1)
    path = _path(np.interp(places, arc, x), np.interp(places, arc, y))
    own = np.interp(chords, at, arc[1:])
    drives = points["v"] > 0.0
    cruise = np.interp(places, own[drives], points["v"][drives])
    start = places[round(LEAD_IN / SPACING)]
    stops = own[1:-1][~drives[1:-1] & drives[:-2]] - start
    stops = np.round(stops / SPACING) * SPACING
    inside = stops[(stops >= SHORTEST) & (stops <= arc[-1] - start - SHORTEST)]
    return make_legs(path, inside.tolist(), cruise)


def _hermite(
    points: Mapping[str, Floats], chords: Floats, directions: Floats
) -> Callable[[int, Floats], Floats]:
    """Return the cubic curve through points with directions: of coordinate 0 or 1, at chords."""
    keys = ("x", "y")

    def at(axis: int, s: Floats) -> Floats:
        i = np.clip(np.searchsorted(chords, s, side="right") - 1, 0, len(chords) - 2)
        h = chords[i + 1] - chords[i]
        t = (s - chords[i]) / h
        p, m = points[keys[axis]], directions[:, axis]
        value: Floats = (
            (1.0 + 2.0 * t) * (1.0 - t) ** 2 * p[i]
            + t * (1.0 - t) ** 2 * h * m[i]
            + t**2 * (3.0 - 2.0 * t) * p[i + 1]
            + t**2 * (t - 1.0) * h * m[i + 1]
        )
        return value

    return at


def _path(x: Floats, y: Floats) -> Path:
    """Return the path through evenly spaced points on level ground."""
    yaw = np.unwrap(np.arctan2(np.gradient(y), np.gradient(x)))
    level = np.zeros_like(x)
    return Path(x, y, level, yaw, np.gradient(yaw, SPACING), level)
