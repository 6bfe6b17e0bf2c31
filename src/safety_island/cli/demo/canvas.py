"""A small map of a course in braille characters, two by four dots each."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from safety_island.sim.courses import Course

Floats = npt.NDArray[np.float64]

_DOTS = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]])
"""Bit of each dot in a braille character, by row and column."""

_BLANK = 0x2800


class CourseMap:
    """The path of a course, drawn once to scale; ``rows`` puts a marker on it."""

    def __init__(self, course: Course, columns: int, rows: int) -> None:
        stations, x, y = _path(course)
        self._stations = stations
        scale = max(np.ptp(x) / (2 * columns - 1), np.ptp(y) / (4 * rows - 1), 1e-9)
        self._column = np.round((x - x.min()) / scale).astype(int)
        self._row = np.round((y.max() - y) / scale).astype(int)
        height, width = int(self._row.max()) // 4 + 1, int(self._column.max()) // 2 + 1
        cells = np.zeros((height, width), int)
        bits = _DOTS[self._row % 4, self._column % 2]
        np.bitwise_or.at(cells, (self._row // 4, self._column // 2), bits)
        self._rows = ["".join(chr(_BLANK + int(cell)) for cell in row) for row in cells]

    def rows(self, station: float) -> tuple[list[str], int, int]:
        """Return the rows of the map, and row and column of the character at a station [m]."""
        index = min(int(np.searchsorted(self._stations, station)), len(self._stations) - 1)
        return self._rows, int(self._row[index]) // 4, int(self._column[index]) // 2


def _path(course: Course) -> tuple[Floats, Floats, Floats]:
    """Station, x and y of the points from the start of the course on."""
    parts = [leg.points[leg.start :] for leg in course.legs]
    x, y = (np.concatenate([part[name] for part in parts]) for name in ("x", "y"))
    stations = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])
    return stations, x, y
