# SPDX-License-Identifier: Apache-2.0
"""Looks whether the limits of this process leave the memory that a command needs, before it starts.

Libraries take it ill when they get none in their start: OpenBLAS tries again for ever with the
interpreter locked, so that no signal is answered, and the DDS library aborts.
"""

from __future__ import annotations

import resource
from typing import NamedTuple

from safety_island.errors import IslandError

MB = 1 << 20


class MemoryLimitError(IslandError):
    """A resource limit that is below what a start needs."""

    exit_code = 70


class Need(NamedTuple):
    """What a command takes, measured from its start to its work, with a reserve [MB]."""

    address_space: int
    """Most of it is reserved for heaps and stacks of threads, and never touched."""
    data: int
    """What can be written and is shared with nobody."""
    kernels: bool = False
    """Whether the compiler is a part of it, where kernels do not come from a library."""


COMPILER = Need(250, 80)
"""The compiler's part."""
_ENOUGH_TO_LOOK = 300
"""Address space [MB] in which NumPy can be loaded."""


class _Limit(NamedTuple):
    number: int
    name: str
    option: str


_LIMITS = (
    _Limit(resource.RLIMIT_AS, "RLIMIT_AS", "-v"),
    _Limit(resource.RLIMIT_DATA, "RLIMIT_DATA", "-d"),
)


def check_memory_limit(command: str, need: Need | None) -> None:
    """Raise MemoryLimitError when a limit is below what the command needs (None: unknown)."""
    if need is None:
        return
    for limit, wanted, compiler in zip(_LIMITS, need[:2], COMPILER[:2], strict=True):
        soft, _ = resource.getrlimit(limit.number)
        allowed = soft // MB
        if soft == resource.RLIM_INFINITY or allowed >= wanted:
            continue
        if need.kernels and allowed >= _ENOUGH_TO_LOOK and _is_compiled():
            wanted -= compiler
        if allowed < wanted:
            raise MemoryLimitError(
                f"{limit.name} is {allowed} MB and 'island {command}' needs {wanted} MB: "
                f"allow more (ulimit {limit.option} {wanted * 1024}), or limit what it really uses "
                "(MemoryMax= of systemd)"
            )


def _is_compiled() -> bool:
    from safety_island.kernel import library

    return library.find_library() is not None
