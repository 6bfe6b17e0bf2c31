# SPDX-License-Identifier: Apache-2.0
"""Whether an input comes as often as it should."""

from __future__ import annotations

WINDOW = 100
"""Samples, at least, over which the rate is taken."""

LOWEST_SHARE = 0.9
"""Share of the expected rate below which the rate is too low."""


class RateMeter:
    """Measures from look to look, over WINDOW samples or more; ``too_low`` is what that said last.

    ``expected_hz`` [Hz] None: any rate will do. Told the time [s, monotonic].
    """

    def __init__(self, expected_hz: float | None) -> None:
        self.too_low = False
        self._longest_s = 1.0 / (LOWEST_SHARE * expected_hz) if expected_hz else 0.0
        """From one sample to the next."""
        self._received = 0
        self._since = 0.0

    def look(self, received: int, now: float) -> None:
        """Take how many samples have come in all."""
        if not self._longest_s:
            return
        count = received - self._received
        if self._received:
            if count < WINDOW:
                return
            self.too_low = now - self._since > self._longest_s * count
        self._received, self._since = received, now
