# SPDX-License-Identifier: Apache-2.0
"""How a process is told to end, and how it ends."""

from __future__ import annotations

import ctypes
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NoReturn

from safety_island.platform.signals import stop_signals

_PR_SET_PDEATHSIG = 1
_PAGE = os.sysconf("SC_PAGE_SIZE")
_STATM = Path("/proc/self/statm")


def memory_bytes() -> int:
    """Resident set size of this process [byte]; 0 where the kernel does not tell."""
    try:
        return int(_STATM.read_text("ascii").split()[1]) * _PAGE
    except OSError:
        return 0


@contextmanager
def on_stop(callback: Callable[[], None]) -> Iterator[None]:
    """Call ``callback`` on SIGINT, SIGTERM and SIGHUP while the context lasts.

    Python delivers signals to the main thread alone; in another thread nothing is installed.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.signal(number, lambda *_: callback()) for number in stop_signals()}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def end_with(parent: int) -> None:
    """Let the kernel end this process as soon as its parent is gone, however that ended."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    if os.getppid() != parent:  # it was gone already
        os._exit(1)


def leave(code: int) -> NoReturn:
    """End the process at once; call it when everything is closed.

    The ordinary end takes apart every module and the compiler: up to a second on a busy machine.
    """
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)
