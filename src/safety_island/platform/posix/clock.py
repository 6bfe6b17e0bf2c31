# SPDX-License-Identifier: Apache-2.0
"""The machine's clocks."""

from __future__ import annotations

import time


class PosixClock:
    """``CLOCK_MONOTONIC``, and a wall clock that is the machine's own until an offset is set."""

    def __init__(self) -> None:
        self._offset_ns: int | None = None
        self.monotonic_ns = time.monotonic_ns

    def wall_ns(self) -> int:
        """Wall clock [ns since 1970]."""
        if self._offset_ns is None:
            return time.time_ns()
        return self.monotonic_ns() + self._offset_ns

    def now(self) -> float:
        """Wall clock [s since 1970]."""
        return self.wall_ns() / 1e9

    def set_wall_offset_ns(self, offset_ns: int | None) -> None:
        """Let the wall clock be the monotonic one plus this; the machine's clock is not touched."""
        self._offset_ns = offset_ns

    def slept_ns(self) -> int:
        """Time [ns] for which the machine was suspended since it booted."""
        return time.clock_gettime_ns(time.CLOCK_BOOTTIME) - time.monotonic_ns()
