# SPDX-License-Identifier: Apache-2.0
"""Kernel: a time as the stamp of a message."""

from safety_island.kernel.cdr import NANOSECONDS
from safety_island.kernel.kernel import kernel

_EARLIEST, _LATEST = -(1 << 31), (1 << 31) - 1
"""Seconds that ``builtin_interfaces/msg/Time`` can hold."""


@kernel
def write_stamp(time, nanoseconds):
    """Write a wall-clock time [ns] as a stamp; False, and nothing written, when it does not fit."""
    seconds = nanoseconds // NANOSECONDS
    if seconds < _EARLIEST or seconds > _LATEST:
        return False
    time.sec = seconds
    time.nanosec = nanoseconds - seconds * NANOSECONDS
    return True
