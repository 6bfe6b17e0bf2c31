# SPDX-License-Identifier: Apache-2.0
"""Bounds for a piece of work on hostile input: processor time, memory."""

from __future__ import annotations

import resource
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

CPU_S = 20.0
"""Far more than any of the files needs, on any machine: what takes longer does not end."""

MEMORY = 1 << 30
"""Bytes on top of what the process has."""


class StillAtItError(BaseException):
    """The work does not end; no Exception, so that no reader takes it for one of its own."""


@contextmanager
def limited(cpu_s: float = CPU_S, memory: int = MEMORY) -> Iterator[None]:
    """Raise StillAtItError after so much processor time, MemoryError beyond so much memory."""

    def give_up(number: int, frame: FrameType | None) -> None:
        raise StillAtItError(f"still at it after {cpu_s:g} s of processor time")

    before = resource.getrlimit(resource.RLIMIT_AS)
    size = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    handler = signal.signal(signal.SIGVTALRM, give_up)
    signal.setitimer(signal.ITIMER_VIRTUAL, cpu_s)
    resource.setrlimit(resource.RLIMIT_AS, (size + memory, before[1]))
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, handler)
        resource.setrlimit(resource.RLIMIT_AS, before)
