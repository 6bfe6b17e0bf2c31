# SPDX-License-Identifier: Apache-2.0
"""Facts about this process."""

from __future__ import annotations

import os
import time
from pathlib import Path

_STARTTIME = 19
"""Field of /proc/self/stat after the command's name: start since boot, in clock ticks."""


def seconds_since_start() -> float:
    """Time [s] since this process was started, interpreter and imports included (to 10 ms)."""
    fields = Path("/proc/self/stat").read_text().rpartition(")")[2].split()
    started = int(fields[_STARTTIME]) / os.sysconf("SC_CLK_TCK")
    return time.clock_gettime(time.CLOCK_BOOTTIME) - started
