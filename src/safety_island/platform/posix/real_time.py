# SPDX-License-Identifier: Apache-2.0
"""Real-time scheduling: a fixed priority, a processor core, memory that stays in place.

The thread that calls is the control thread. Every other thread of the process gets a fixed priority
as well, a lower one: those of the DDS library bring the inputs, and a Python thread that were kept
from running while it holds the interpreter would stop the control thread too.
"""

from __future__ import annotations

import ctypes
import os
import resource
import threading
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from safety_island.errors import ConfigurationError, IslandError

MODES = ("auto", "require", "off")
ANY_CPU, CHOOSE_CPU = "any", "auto"

_LOCK_ALL = (
    1 | 2 | 4
)  # MCL_CURRENT, MCL_FUTURE, MCL_ONFAULT: what is used stays; stacks are not filled
_CAP_IPC_LOCK = 14
_ISOLATED = Path("/sys/devices/system/cpu/isolated")
_TASKS = Path("/proc/self/task")


class RealTimeError(IslandError):
    """Real-time scheduling was demanded and is not to be had."""


@dataclass(frozen=True)
class Priorities:
    """Priorities of SCHED_FIFO, 1 to 99: of the control thread, and of the others below it."""

    control: int
    others: int


ISLAND = Priorities(50, 40)
BRIDGE = Priorities(30, 20)
"""Below all of the island: a flood that keeps the bridge busy must not keep the island waiting."""


@dataclass
class RealTime:
    """What was asked for: what came of it, and what is missing, each with the way to get it."""

    got: list[str] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        got = ", ".join(self.got) or "nothing"
        missing = (
            f"; missing: {', '.join(self.missing)} (allow it: {GRANT})" if self.missing else ""
        )
        return f"real time: {got}{missing}"


GRANT = "sudo prlimit --pid $$ --rtprio=50 --memlock=unlimited, then start from that shell"
"""The command that grants all of it to what the shell starts."""


def take_real_time(
    mode: str, cpu: str, priorities: Priorities, *, rank: int = 0
) -> RealTime | None:
    """Take what this process may have; None: ``mode`` is off.

    ``cpu``: number of a core, ``any`` or ``auto``; with ``auto`` the core that is ``rank`` from the
    last. Call it from the control thread when every thread is there. Raises RealTimeError when
    ``mode`` is require and anything is missing.
    """
    if mode == "off":
        return None
    result = RealTime()
    _schedule(priorities, result)
    if result.got or cpu != CHOOSE_CPU:  # at ordinary priority it would share its core with others
        _pin(cpu, rank, result)
    _lock_memory(result)
    if mode == "require" and result.missing:
        raise RealTimeError(f"--realtime require: {result}")
    return result


def parse_cpu(text: str) -> str:
    """Check the text of ``cpu``. Raises ConfigurationError."""
    if text in (ANY_CPU, CHOOSE_CPU):
        return text
    allowed = sorted(os.sched_getaffinity(0))
    if not (text.isascii() and text.isdigit() and int(text) in allowed):
        raise ConfigurationError(
            f"'{text}' is not a core that this process may use, expected auto, any or one of "
            f"{', '.join(map(str, allowed))}"
        )
    return text


def _schedule(priorities: Priorities, result: RealTime) -> None:
    allowed = _allowed_priority(priorities.control)
    control = min(priorities.control, allowed)
    others = min(priorities.others, max(control - 1, 1))
    try:
        if not allowed:
            raise PermissionError
        own = threading.get_native_id()
        for thread in [int(task.name) for task in _TASKS.iterdir()]:
            priority = control if thread == own else others
            _set_priority(thread, priority)
    except OSError as error:
        why = "" if isinstance(error, PermissionError) else f" ({error.strerror})"
        result.missing.append(f"SCHED_FIFO priority {priorities.control}{why}")
        return
    result.got.append(f"SCHED_FIFO priority {control} (other threads {others})")
    if control < priorities.control:
        result.missing.append(f"priority {priorities.control} (RLIMIT_RTPRIO is {control})")


def _set_priority(thread: int, priority: int) -> None:
    try:
        os.sched_setscheduler(thread, os.SCHED_FIFO, os.sched_param(priority))
    except ProcessLookupError:  # it ended meanwhile
        return


def _allowed_priority(wanted: int) -> int:
    """Return the highest priority that may be taken; the soft limit is raised where it can be."""
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(wanted))
        return wanted
    except OSError:
        soft, hard = resource.getrlimit(resource.RLIMIT_RTPRIO)
        if hard != soft:
            resource.setrlimit(resource.RLIMIT_RTPRIO, (hard, hard))
        return wanted if hard == resource.RLIM_INFINITY else hard


def _pin(cpu: str, rank: int, result: RealTime) -> None:
    allowed = sorted(os.sched_getaffinity(0))
    if cpu == ANY_CPU:
        return
    if cpu == CHOOSE_CPU:
        if len(allowed) == 1:
            result.got.append(f"core {allowed[0]}, the only one")
            return
        candidates = [one for one in _isolated() if one in allowed] or allowed
        core = candidates[-1 - rank % len(candidates)]
    else:
        core = int(cpu)
    try:
        os.sched_setaffinity(0, {core})
    except OSError as error:
        result.missing.append(f"core {core} ({error.strerror})")
        return
    result.got.append(f"core {core}")


def _isolated() -> Sequence[int]:
    """Return the cores that the kernel keeps free of other work (``isolcpus``): ``2,4-7``."""
    try:
        text = _ISOLATED.read_text("ascii").strip()
    except OSError:
        return []
    spans = [part.split("-") for part in text.split(",") if part]
    return [core for span in spans for core in range(int(span[0]), int(span[-1]) + 1)]


def _lock_memory(result: RealTime) -> None:
    """Lock what is used now and later; under a limit not, where a later allocation would fail."""
    if not _may_lock_all():
        soft, _ = resource.getrlimit(resource.RLIMIT_MEMLOCK)
        result.missing.append(f"locked memory (RLIMIT_MEMLOCK is {soft >> 10} kB)")
        return
    library = ctypes.CDLL(None, use_errno=True)
    if library.mlockall(_LOCK_ALL):
        result.missing.append(f"locked memory ({os.strerror(ctypes.get_errno())})")
        return
    result.got.append("locked memory")


def _may_lock_all() -> bool:
    _, hard = resource.getrlimit(resource.RLIMIT_MEMLOCK)
    if hard == resource.RLIM_INFINITY:
        resource.setrlimit(resource.RLIMIT_MEMLOCK, (hard, hard))
        return True
    status = Path("/proc/self/status").read_text("utf-8")
    effective = next(line for line in status.splitlines() if line.startswith("CapEff:"))
    return bool(int(effective.split()[1], 16) >> _CAP_IPC_LOCK & 1)
