"""What the C library says on standard error while it starts: it says it nowhere else."""

from __future__ import annotations

import os
import re
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from typing import IO

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
def captured_stderr() -> Iterator[Captured]:
    """Collect file descriptor 2 for the whole process while the block runs.

    Text of a block that raises is kept for the caller; otherwise it goes on to standard error.
    """
    captured = Captured()
    sys.stderr.flush()
    saved = os.dup(_STDERR)
    with tempfile.TemporaryFile() as collected:
        os.dup2(collected.fileno(), _STDERR)
        try:
            yield captured
        except BaseException:
            _restore(saved, collected, captured)
            raise
        _restore(saved, collected, captured)
    if captured.raw:
        sys.stderr.write(captured.raw)


def _restore(saved: int, collected: IO[bytes], captured: Captured) -> None:
    os.dup2(saved, _STDERR)
    os.close(saved)
    collected.seek(0)
    captured.raw = collected.read().decode("utf-8", "replace")
