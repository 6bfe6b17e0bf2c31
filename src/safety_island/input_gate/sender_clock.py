# SPDX-License-Identifier: Apache-2.0
"""The clock of the sender of all inputs, as Python sees it; its rules are those of ``clock``."""

from __future__ import annotations

from safety_island.input_gate.clock.records import new_clock, new_stamps
from safety_island.input_gate.clock.sender import measure_sender_clock, read_sender_clock
from safety_island.kernel.records import Records, cells

LARGEST_RATE_ERROR = 0.01
"""Difference of the common rate from 1 that is warned of; two real clocks differ by 0.001."""


class SenderClock:
    """Compares the inputs that ``add`` gives a place in ``stamps``. Times in s, monotonic."""

    def __init__(self) -> None:
        self.stamps: Records = new_stamps()
        """STAMPS of each input."""
        self.state: Records = new_clock()
        """CLOCK record of shape (1,)."""
        self._count = 0
        cell = cells(self.state)
        self._rate_error, self._time_ns = cell["rate_error"], cell["time_ns"]
        self._measure = measure_sender_clock.bind(self.stamps, self.state)
        self._read = read_sender_clock.bind(self.stamps, self.state)

    def add(self, limit_s: float) -> int:
        """Return the place of one more input, with this age limit [s]."""
        place, self._count = self._count, self._count + 1
        self.stamps["limit_s"][place] = limit_s
        return place

    @property
    def rate_error(self) -> float:
        """Common rate of the stamps, less 1; 0 when they do not agree."""
        return float(self._rate_error[0])

    @property
    def is_off(self) -> bool:
        """Whether the clock runs at another rate than the island's own."""
        return abs(self.rate_error) > LARGEST_RATE_ERROR

    def stamp_ns(self, now: float) -> int | None:
        """Return the time by the sender's clock [ns], None when no input is heard."""
        return int(self._time_ns[0]) if self._read(now) else None

    def measure(self, now: float) -> None:
        """Measure the rate, when the window is over."""
        self._measure(now)
