# SPDX-License-Identifier: Apache-2.0
"""Standard streams as they may be found: closed, full, or with nobody at the other end."""

from __future__ import annotations

import errno
import os
import sys
from typing import TextIO

_MODES = {"stdin": "r", "stdout": "w", "stderr": "w"}
_NO_ROOM = (errno.ENOSPC, errno.EDQUOT)


def open_missing() -> None:
    """Point standard streams that were closed at the null device.

    The descriptors 0 to 2 would else go to the next sockets that are opened, and a log line into a
    bus or a network.
    """
    for number, (name, mode) in enumerate(_MODES.items()):
        if not _is_open(number):
            _point_at_null(number)
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(number, mode, closefd=False))


def give_up(stream: TextIO) -> None:
    """Point a standard stream at the null device: the interpreter writes once more at its end."""
    _point_at_null(stream.fileno())


def is_full(error: OSError) -> bool:
    """Whether a write failed because there is no room for it."""
    return error.errno in _NO_ROOM


def _is_open(number: int) -> bool:
    try:
        os.fstat(number)
    except OSError:
        return False
    return True


def _point_at_null(number: int) -> None:
    null = os.open(os.devnull, os.O_RDWR)
    if null == number:
        os.set_inheritable(number, True)
    else:
        os.dup2(null, number)
        os.close(null)
