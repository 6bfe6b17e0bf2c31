# SPDX-License-Identifier: Apache-2.0
"""When a bus that failed is tried again."""

from __future__ import annotations

from enum import Enum, auto

from safety_island.platform.interfaces import CanResult

FIRST_BACKOFF_S = 0.2
LAST_BACKOFF_S = 5.0

_SOFT = (CanResult.QUEUE_FULL, CanResult.FAILED)


class Remedy(Enum):
    """What to do before the next command."""

    NONE = auto()
    DISCARD = auto()
    """Throw away what waits to be sent: a part of a command must not leave later."""
    REOPEN = auto()
    WAIT = auto()
    """Nothing is sent until the back-off has passed."""


class Recovery:
    """Back-off after failures: none before the first new attempt, then 0.2 s, doubling to 5 s.

    A full queue, or a failure without a known cause, is first met with a new command on the same
    open bus; what the bus itself reports as down is opened again. Times are monotonic [s].
    """

    def __init__(self) -> None:
        self.failures = 0
        """Failures in a row."""
        self.last = CanResult.SENT
        """What the last failure was."""
        self._retry_s = 0.0

    def succeed(self) -> None:
        """The bus took a command."""
        self.failures = 0
        self.last = CanResult.SENT

    def fail(self, result: CanResult, now_s: float) -> None:
        """The bus did not take a command."""
        backoff = FIRST_BACKOFF_S * 2.0 ** min(self.failures - 1, 10) if self.failures else 0.0
        self.failures += 1
        self.last = result
        self._retry_s = now_s + min(backoff, LAST_BACKOFF_S)

    def remedy(self, now_s: float) -> Remedy:
        """Tell what to do before the next command."""
        if not self.failures:
            return Remedy.NONE
        if now_s < self._retry_s:
            return Remedy.WAIT
        if self.failures == 1 and self.last in _SOFT:
            return Remedy.DISCARD
        return Remedy.REOPEN
