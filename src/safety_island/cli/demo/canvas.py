# SPDX-License-Identifier: Apache-2.0
"""A map of a course in braille characters, two by four dots each, with the vehicle on it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import groupby
from operator import itemgetter

import numpy as np
import numpy.typing as npt
from rich.text import Text

from safety_island.sim.courses import Course

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

_DOTS = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]])
"""Bit of each dot in a braille character, by row and column."""

_BLANK = 0x2800
ARROWS = "→↗↑↖←↙↓↘"
"""The vehicle, by its heading in eighths of a turn."""
TARGET = "◎"
STEEP = 0.01
"""Slope [rad] from which on the road is drawn as a climb or a descent."""

PATH, UP, DOWN, TRAIL, VEHICLE, GOAL = (
    "cyan",
    "bright_red",
    "bright_blue",
    "bold green",
    "bold yellow",
    "bold magenta",
)
BARS = "▁▂▃▄▅▆▇█"


class CourseMap:
    """The path of a course to scale in at most ``columns`` x ``rows`` characters.

    Places are given by station and lateral error [m], which hold in every lap.
    """

    def __init__(self, course: Course, columns: int, rows: int) -> None:
        self._stations, x, y, z = _path(course)
        self.height = self.width = 0
        self._x, self._y, self._z = x, y, z
        self._yaw = np.unwrap(np.arctan2(np.gradient(y), np.gradient(x)))
        self.slope = np.gradient(z) / np.maximum(np.hypot(np.gradient(x), np.gradient(y)), 1e-9)
        self.scale = max(np.ptp(x) / (2 * columns - 1), np.ptp(y) / (4 * rows - 1), 1e-9)
        slope = self.slope
        if self._stations[-1] > 0.5 * self.scale * len(x):  # else there would be gaps
            count = int(2.0 * self._stations[-1] / self.scale) + 2
            stations = np.linspace(0.0, self._stations[-1], count)
            x, y = (np.interp(stations, self._stations, values) for values in (x, y))
            slope = np.interp(stations, self._stations, slope)
        dots = self._dots(x, y)
        self.height = int(dots[0].max()) // 4 + 1
        self.width = int(dots[1].max()) // 2 + 1
        self._path_cells = self._cells(*dots)
        self._styles = np.full((self.height, self.width), PATH, dtype=object)
        for style, steep in ((UP, slope > STEEP), (DOWN, slope < -STEEP)):
            self._styles[dots[0][steep] // 4, dots[1][steep] // 2] = style

    @property
    def is_flat(self) -> bool:
        """Whether the course has no slope."""
        return bool(np.ptp(self._z) < STEEP)

    def draw(
        self,
        place: tuple[float, float],
        trail: Sequence[tuple[float, float]] = (),
        target: float | None = None,
    ) -> Text:
        """Return the map: the vehicle at a place, the places where it was, the next stop [m]."""
        cells, styles = self._path_cells.copy(), self._styles.copy()
        if trail:
            stations, errors = np.array(trail).T
            dots = self._dots(*self._positions(stations, errors))
            driven = self._cells(*dots)
            cells |= driven
            styles[driven > 0] = TRAIL
        shown = np.array([[chr(_BLANK + int(cell)) for cell in row] for row in cells], dtype=object)
        if target is not None:
            self._mark(shown, styles, (target, 0.0), TARGET, GOAL)
        self._mark(shown, styles, place, self._arrow(place[0]), VEHICLE)
        return _text(shown, styles)

    def profile(self, station: float, columns: int, rows: int = 1) -> Text:
        """Return the height of the road over its length in some rows, with the vehicle on it."""
        at = np.linspace(0.0, self._stations[-1], columns)
        heights = np.interp(at, self._stations, self._z)
        share = (heights - self._z.min()) / max(np.ptp(self._z), 1e-9)
        slopes = np.interp(at, self._stations, self.slope)
        here = min(round(station / self._stations[-1] * (columns - 1)), columns - 1)
        filled = 1 + np.round(share * (rows * len(BARS) - 1)).astype(int)  # in eighths of a row
        style = np.where(slopes > STEEP, UP, np.where(slopes < -STEEP, DOWN, PATH)).astype(object)
        style[here] = VEHICLE
        shown = [
            [f" {BARS}"[min(max(eighths - above, 0), len(BARS))] for eighths in filled]
            for above in range((rows - 1) * len(BARS), -1, -len(BARS))
        ]
        return _text(shown, [style] * rows)

    def _arrow(self, station: float) -> str:
        yaw = float(np.interp(station, self._stations, self._yaw))
        return ARROWS[round(yaw / (math.pi / 4)) % 8]

    def _positions(self, stations: Floats, errors: Floats) -> tuple[Floats, Floats]:
        """x and y [m] in the frame of the map."""
        x = np.interp(stations, self._stations, self._x)
        y = np.interp(stations, self._stations, self._y)
        yaw = np.interp(stations, self._stations, self._yaw)
        return x - errors * np.sin(yaw), y + errors * np.cos(yaw)

    def _dots(self, x: Floats, y: Floats) -> tuple[Ints, Ints]:
        """Row and column of the dots at positions [m]; what lies beyond is drawn at the edge."""
        column = np.round((x - self._x.min()) / self.scale).astype(int)
        row = np.round((self._y.max() - y) / self.scale).astype(int)
        if self.height:  # known once the path has been laid out
            row, column = row.clip(0, 4 * self.height - 1), column.clip(0, 2 * self.width - 1)
        return row, column

    def _cells(self, row: Ints, column: Ints) -> Ints:
        cells = np.zeros((self.height, self.width), int)
        np.bitwise_or.at(cells, (row // 4, column // 2), _DOTS[row % 4, column % 2])
        return cells

    def _mark(
        self,
        shown: npt.NDArray[np.object_],
        styles: npt.NDArray[np.object_],
        place: tuple[float, float],
        mark: str,
        style: str,
    ) -> None:
        row, column = self._dots(*self._positions(np.array([place[0]]), np.array([place[1]])))
        cell = int(row[0]) // 4, int(column[0]) // 2
        shown[cell], styles[cell] = mark, style


def _text(shown: Iterable[Iterable[str]], styles: Iterable[Iterable[str]]) -> Text:
    """Rows of characters, each with its style, as one text."""
    text = Text(no_wrap=True, overflow="crop")
    for number, (characters, row) in enumerate(zip(shown, styles, strict=True)):
        if number:
            text.append("\n")
        for style, run in groupby(zip(characters, row, strict=True), key=itemgetter(1)):
            text.append("".join(character for character, _ in run), style=style)
    return text


def _path(course: Course) -> tuple[Floats, Floats, Floats, Floats]:
    """Station, x, y and z of the points from the start of the course on."""
    parts = [leg.points[leg.start :] for leg in course.legs]
    x, y, z = (np.concatenate([part[name] for part in parts]) for name in ("x", "y", "z"))
    steps = np.hypot(np.diff(x), np.diff(y))
    keep = np.concatenate([[True], steps > 1e-9])  # a leg begins where the one before ended
    x, y, z = (np.asarray(values[keep], dtype=np.float64) for values in (x, y, z))
    return np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))]), x, y, z
