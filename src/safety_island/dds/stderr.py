# SPDX-License-Identifier: Apache-2.0
"""What the C library says on standard error while it starts: it says it nowhere else."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import IO

from safety_island.dds.library_log import library_log, write

_STDERR = 2
_PREFIX = re.compile(r"^\d+\.\d+ \[\w*\]\s+\S+?:\s*", re.MULTILINE)


class Captured:
    """The text that was written to standard error, without the library's time stamps."""

    def __init__(self) -> None:
        self.raw = ""

    @property
    def cause(self) -> str:
        """All lines as one, for an error message."""
        return cause(self.raw)


def cause(text: str) -> str:
    """Return lines of the library as one, without their time stamps."""
    return "; ".join(line.strip() for line in _PREFIX.sub("", text).splitlines() if line)


@contextmanager
def captured_log(traced: bool) -> Iterator[Captured]:
    """Collect what the library says while a domain starts; later lines of it are throttled.

    Text of a block that raises is kept for the caller; otherwise it goes on to standard error. A
    domain whose trace was asked for (``traced``) goes on to write to standard error itself.
    """
    captured = Captured()
    if traced:
        with _captured_descriptor(captured):
            yield captured
        sys.stderr.write(captured.raw)
        return
    logged: list[str] = []
    try:
        with library_log(logged), _captured_descriptor(captured):
            yield captured
    finally:
        captured.raw += "".join(logged)
    write(captured.raw)


@contextmanager
def _captured_descriptor(captured: Captured) -> Iterator[None]:
    """Collect file descriptor 2 for the whole process while the block runs."""
    sys.stderr.flush()
    saved = os.dup(_STDERR)
    with os.fdopen(os.memfd_create("stderr"), "w+b") as collected:
        os.dup2(collected.fileno(), _STDERR)
        try:
            yield
        finally:
            _restore(saved, collected, captured)


def _restore(saved: int, collected: IO[bytes], captured: Captured) -> None:
    os.dup2(saved, _STDERR)
    os.close(saved)
    collected.seek(0)
    captured.raw = collected.read().decode("utf-8", "replace")
