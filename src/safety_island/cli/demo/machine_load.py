# SPDX-License-Identifier: Apache-2.0
"""How busy the machine is with other work than the demo's."""

from __future__ import annotations

import os
from pathlib import Path
from typing import NamedTuple

_STAT = Path("/proc/stat")
_HZ = os.sysconf("SC_CLK_TCK")
_IDLE = (3, 4)
"""Fields of /proc/stat in which a core does nothing: idle, and waiting for a disk."""
_GUESTS = 8
"""Fields from here on are part of those before."""

BUSY_CORES = 0.25
"""Other work counts as a busy machine from this share of its cores on."""


class Usage(NamedTuple):
    """Processor time [s] since the start of the machine, over all cores."""

    total: float
    busy: float
    own: float
    """Of this process and of its children that have ended."""


class OtherWork(NamedTuple):
    """Cores that other programs used on average, of how many."""

    cores: float
    of: int

    @property
    def is_much(self) -> bool:
        """Whether ticks can be late for it."""
        return self.cores >= BUSY_CORES * self.of


def usage() -> Usage | None:
    """Read it; None where the machine does not tell."""
    try:
        fields = _STAT.read_text().splitlines()[0].split()[1:]
    except OSError:
        return None
    times = [int(field) / _HZ for field in fields[:_GUESTS]]
    own = sum(os.times()[:4])
    total = sum(times)
    return Usage(total, total - sum(times[place] for place in _IDLE), own)


def other_work(before: Usage | None, after: Usage | None) -> OtherWork | None:
    """Return what others used between two readings; the demo's children ended in between."""
    if before is None or after is None or after.total <= before.total:
        return None
    cores = os.cpu_count() or 1
    others = (after.busy - before.busy) - (after.own - before.own)
    share = max(0.0, others) / (after.total - before.total)
    return OtherWork(share * cores, cores)
