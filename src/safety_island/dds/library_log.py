# SPDX-License-Identifier: Apache-2.0
"""What the library logs while it runs, brought into our form and throttled.

It writes to the C stream ``stderr`` that a domain found when it was started, a line for each packet
that could not be sent. So each domain gets a stream of ours in its place: a pipe that a thread
reads, which sleeps until there is a line. A full pipe drops lines and never blocks the library.
"""

from __future__ import annotations

import ctypes as ct
import os
import re
import select
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager

QUIET_S = 10.0
"""For how long [s] a line like one before is only counted."""
_MOST_KINDS = 256
_LINE = re.compile(r"^(\d+\.\d+) \[\w*\]\s+\S+?:\s*(.*)$")
_libc = ct.CDLL(None)
_open_stream = ct.CFUNCTYPE(ct.c_void_p, ct.c_int, ct.c_char_p)(("fdopen", _libc))


class Throttle:
    """Lets the first line of a kind through, then one in ten seconds with the count of the rest.

    Lines are of one kind when only their numbers differ. The time is that of the library's stamps.
    """

    def __init__(self) -> None:
        self._told: dict[str, float] = {}
        self._held: dict[str, int] = {}

    def __call__(self, line: str) -> str | None:
        """Return what is to be written for a line of the library; None when nothing is."""
        found = _LINE.match(line)
        if found is None:
            return line.strip() or None
        time_s, text = float(found[1]), found[2]
        kind = re.sub(r"\d+", "0", text)
        if abs(time_s - self._told.get(kind, float("-inf"))) < QUIET_S:
            self._held[kind] = self._held.get(kind, 0) + 1
            return None
        if len(self._told) >= _MOST_KINDS:
            self._told.clear()
        self._told[kind] = time_s
        held = self._held.pop(kind, 0)
        return f"{text} ({held} more like it)" if held else text


class LibraryLog:
    """A C stream for the library, and the thread that writes what comes out of it."""

    def __init__(self) -> None:
        self._reader, writer = os.pipe()
        for end in (self._reader, writer):
            os.set_blocking(end, False)
        self._stream = _open_stream(writer, b"w")
        self._throttle = Throttle()
        self._lock = threading.Lock()
        self._rest = ""
        threading.Thread(target=self._follow, name="dds-log", daemon=True).start()

    @contextmanager
    def collected(self, found: list[str]) -> Iterator[None]:
        """Let a domain that is started meanwhile log here; what it logs at once is added."""
        stderr = ct.c_void_p.in_dll(_libc, "stderr")
        with self._lock:
            self.write(self._whole_lines(self._text()))
            before, stderr.value = stderr.value, self._stream
            try:
                yield
            finally:
                stderr.value = before
                found.append(self._text())

    def _text(self) -> str:
        try:
            return os.read(self._reader, 1 << 20).decode("utf-8", "replace")
        except BlockingIOError:
            return ""

    def write(self, text: str) -> None:
        """Write the lines that are due."""
        for line in text.splitlines():
            if due := self._throttle(line):
                print(f"island: DDS: {due}", file=sys.stderr, flush=True)

    def _follow(self) -> None:
        while True:
            select.select([self._reader], [], [])
            with self._lock:
                self.write(self._whole_lines(self._text()))

    def _whole_lines(self, text: str) -> str:
        whole, _, self._rest = (self._rest + text).rpartition("\n")
        return whole


@contextmanager
def library_log(found: list[str]) -> Iterator[None]:
    """Add what a domain that is started meanwhile logs to a list; the stream takes the rest."""
    global _log
    if _log is None:
        _log = LibraryLog()
    with _log.collected(found):
        yield


def write(text: str) -> None:
    """Write lines of the library that are due."""
    if _log is not None:
        _log.write(text)


_log: LibraryLog | None = None
