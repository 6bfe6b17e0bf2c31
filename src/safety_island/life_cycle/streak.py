# SPDX-License-Identifier: Apache-2.0
"""How often or how long something has gone wrong without a break."""

from __future__ import annotations

import math


class Streak:
    """Counts failures in a row, and since when [s, monotonic] they go on."""

    def __init__(self) -> None:
        self.forget()

    def forget(self) -> None:
        """End the streak."""
        self.count, self.since = 0, math.inf

    def note(self, failed: bool, now: float) -> None:
        """Note one more time; a success ends the streak."""
        if failed:
            if not self.count:
                self.since = now
            self.count += 1
        elif self.count:
            self.forget()

    def lasts_s(self, now: float) -> float:
        """Time [s] since its first failure; 0 when there is none."""
        return now - self.since if self.count else 0.0
