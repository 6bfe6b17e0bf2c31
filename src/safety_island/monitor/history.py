# SPDX-License-Identifier: Apache-2.0
"""The rows and marks of the last minutes, for a page that is opened or comes back."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from safety_island.monitor.fields import FIELDS, shortened

SECONDS = 600.0
"""How far the page scrolls back [s]."""
MOST_ROWS = 1 << 16
"""Kept at most: ten minutes at 100 Hz."""
MOST_MARKS = 500
CHUNK = 2000
"""Rows in one message."""


class History:
    """A ring of rows, newest last."""

    def __init__(self, most_rows: int = MOST_ROWS) -> None:
        self._ring: npt.NDArray[np.float64] = np.empty((most_rows, len(FIELDS)))
        self._count = 0
        self.marks: deque[dict[str, Any]] = deque(maxlen=MOST_MARKS)

    def add(self, values: list[float]) -> None:
        """Keep a row; the oldest makes room."""
        self._ring[self._count % len(self._ring)] = values
        self._count += 1

    def chunks(self) -> Iterator[list[list[float | None]]]:
        """Yield the rows of the last SECONDS as they are sent, oldest first."""
        rows = self._ordered()
        if len(rows):
            rows = rows[rows[:, 0] >= rows[-1, 0] - SECONDS]
        for start in range(0, len(rows), CHUNK):
            yield [shortened(values) for values in rows[start : start + CHUNK].tolist()]

    def _ordered(self) -> npt.NDArray[np.float64]:
        size = len(self._ring)
        if self._count <= size:
            return self._ring[: self._count]
        return np.roll(self._ring, -(self._count % size), axis=0)
