# SPDX-License-Identifier: Apache-2.0
"""The lines of a log, and what is said of those that cannot be read."""

from __future__ import annotations

import lzma
import re
import zlib
from collections.abc import Iterable, Iterator
from typing import Any

CUT = (EOFError, zlib.error, lzma.LZMAError)
"""What a packed file raises that was cut or damaged; its checksum is an OSError."""
LONGEST = 40
"""Characters of a line that a message shows."""


class LogNotes:
    """What was left out of a log; ``name`` is the file."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.skipped = 0
        self.first = ""
        """Place and text of the first line that was left out."""
        self._ends: list[str] = []

    def skip(self, number: int, line: str) -> None:
        """Note a line that no program writes whose log this is."""
        self.skipped += 1
        self._note_first(number, line)

    def torn(self, number: int, line: str) -> None:
        """Note that the last line is only a part of one."""
        self._ends.append(f"{self.name}:{number}: the last line is torn: {_shortened(line)}")
        self._note_first(number, line)

    def cut(self, why: object) -> None:
        """Note that the rest of the file cannot be read."""
        reason = ascii(str(why))[1:-1].rstrip(".") or type(why).__name__
        self._ends.append(f"{self.name}: cut or damaged, the rest is lost: {reason}")

    def _note_first(self, number: int, line: str) -> None:
        self.first = self.first or f"{self.name}:{number}: found {_shortened(line)}"

    def sentences(self) -> list[str]:
        """Return what is to be said, one line each."""
        if not self.skipped:
            return self._ends
        lines = "1 line is" if self.skipped == 1 else f"{self.skipped} lines are"
        return [f"{self.first}; {lines} not of this log and left out", *self._ends]


def _shortened(line: str) -> str:
    text = line.strip()
    return ascii(text if len(text) <= LONGEST else text[: LONGEST - 3] + "...")


class LogLines:
    """A text file that knows which line was read last, and ends where it cannot be read on."""

    def __init__(self, lines: Iterable[str], notes: LogNotes) -> None:
        self.notes = notes
        self.number = 0
        self.text = ""
        self._lines = iter(lines)
        self._put_in: list[str] = []

    def __iter__(self) -> Iterator[str]:
        return self

    def __next__(self) -> str:
        return self._put_in.pop() if self._put_in else self._read()

    def _read(self) -> str:
        try:
            line = next(self._lines)
        except CUT as error:
            self.notes.cut(error)
            raise StopIteration from error
        self.number, self.text = self.number + 1, line
        return line

    def put_in(self, line: str) -> None:
        """Give this line next; it is not counted."""
        self._put_in.append(line)

    def leave_out(self) -> None:
        """Note that the line that was read last cannot be used."""
        if self.text.endswith("\n"):
            self.notes.skip(self.number, self.text)
        else:
            self.notes.torn(self.number, self.text)

    def close(self) -> None:
        """Who opened the file closes it."""


_RELATIVE = re.compile(r"base\s+\w+\s+timestamps\s+relative", re.IGNORECASE)
_TIME = re.compile(r"(\s*)(\d+\.\d+)(?=\s)")
END_OF_HEADER = "no internal events logged\n"


class AscLines(LogLines):
    """Lines of an ASC log as python-can expects them.

    Its reader loses the line that ends the header, which may be a frame, and takes times that are
    relative to the line before for times since the start.
    """

    def __init__(self, lines: Iterable[str], notes: LogNotes) -> None:
        super().__init__(lines, notes)
        self._is_header, self._is_relative, self._time_s = True, False, 0.0

    def _read(self) -> str:
        line = super()._read()
        if _RELATIVE.match(line.strip()):
            self._is_relative = True
        match = _TIME.match(line)
        if match is None:
            return line
        if self._is_relative:
            self._time_s += float(match[2])
            line = f"{match[1]}{self._time_s:.6f}{line[match.end() :]}"
        if self._is_header:
            self._is_header = False
            self.put_in(line)
            return END_OF_HEADER
        return line


def length_is_wrong(message: Any) -> bool:
    """Whether a frame of python-can has fewer bytes than it says."""
    if message.is_remote_frame or message.is_error_frame:
        return False
    expected: int = message.dlc if message.is_fd else min(message.dlc, 8)
    return len(message.data) < expected
