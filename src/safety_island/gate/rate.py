"""Whether an input comes as often as it should."""

from __future__ import annotations

WINDOW = 100
"""Samples over which the rate is taken."""

LOWEST_SHARE = 0.9
"""Share of the expected rate below which the rate is too low."""


class RateMeter:
    """Measures over WINDOW samples; ``too_low`` is what the last window said.

    ``expected_hz`` [Hz] None: any rate will do. Told the time [s, monotonic].
    """

    def __init__(self, expected_hz: float | None) -> None:
        self.too_low = False
        self._longest_s = WINDOW / (LOWEST_SHARE * expected_hz) if expected_hz else 0.0
        self._count = 0
        self._since = 0.0

    def note(self, count: int, now: float) -> None:
        """Note that ``count`` samples have come."""
        if not self._longest_s:
            return
        if not self._count:
            self._since = now
        self._count += count
        if self._count > WINDOW:
            expected_s = self._longest_s * (self._count - 1) / WINDOW
            self.too_low = now - self._since > expected_s
            self._count = 0
