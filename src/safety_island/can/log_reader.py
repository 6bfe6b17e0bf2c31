"""Reads CAN logs: ``candump -L`` here, Vector and PEAK formats and CSV through python-can."""

from __future__ import annotations

import io
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from safety_island.can.candump import LogEntry, parse_line
from safety_island.errors import IslandError

STANDARD_INPUT = "-"
LONGEST_LINE = 1 << 16
"""Characters of a line; a device or another kind of file may have no end of a line at all."""
_READERS = {".asc": "ASCReader", ".blf": "BLFReader", ".csv": "CSVReader", ".trc": "TRCReader"}
_BINARY = (".blf",)


class LogError(IslandError):
    """A log that cannot be read."""


def read_log(name: str) -> Iterator[LogEntry]:
    """Yield the entries of a log; ``-`` is standard input, always in the form of ``candump -L``.

    Raises LogError, which names the file and the line.
    """
    is_empty = True
    for entry in _entries(name):
        is_empty = False
        yield entry
    if is_empty:
        raise LogError(f"{name}: holds no CAN frame, expected a log of 'candump -L' or python-can")


def _entries(name: str) -> Iterator[LogEntry]:
    if name == STANDARD_INPUT:
        if isinstance(sys.stdin, io.TextIOWrapper):
            sys.stdin.reconfigure(errors="replace")
        yield from _candump(_CountedLines("standard input", sys.stdin))
        return
    suffix = Path(name).suffix.lower()
    try:
        if suffix in _BINARY:
            with Path(name).open("rb") as data:
                yield from _python_can(name, _READERS[suffix], data)
        else:
            with Path(name).open(encoding="utf-8", errors="replace") as lines:
                counted = _CountedLines(name, lines)
                if suffix in _READERS:
                    yield from _python_can(name, _READERS[suffix], counted)
                else:
                    yield from _candump(counted)
    except OSError as error:
        raise LogError(f"{name}: cannot be read: {error.strerror}") from error


def _candump(lines: _CountedLines) -> Iterator[LogEntry]:
    for line in lines:
        if not line.strip():
            continue
        entry = parse_line(line)
        if entry is None:
            raise LogError(
                f"{lines.place}: found {_shortened(line)}, expected a line of 'candump -L' "
                "like '(1700000000.123456) can0 100#48E80100E05EF8FF'"
            )
        yield entry


def _shortened(line: str) -> str:
    text = line.strip()
    return repr(text if len(text) <= 40 else text[:37] + "...")


class _CountedLines:
    """A text file that knows which line was read last, and refuses one without an end."""

    def __init__(self, name: str, lines: Any) -> None:
        self._name, self._lines = name, lines
        self._number = 0

    @property
    def place(self) -> str:
        """Where the line stands that was read last."""
        return f"{self._name}:{self._number}"

    def __iter__(self) -> Iterator[str]:
        return self

    def __next__(self) -> str:
        line: str = self._lines.readline(LONGEST_LINE)
        if not line:
            raise StopIteration
        self._number += 1
        if len(line) == LONGEST_LINE:
            raise LogError(f"{self.place}: a line without an end, expected a CAN log")
        return line

    def __getattr__(self, name: str) -> Any:
        return getattr(self._lines, name)


def _python_can(name: str, reader: str, file: Any) -> Iterator[LogEntry]:
    import can

    from safety_island.can.python_can_bus import entry_of

    try:
        for message in getattr(can, reader)(file):
            yield entry_of(message)
    except LogError:
        raise
    except Exception as error:  # each reader has exceptions of its own for what it cannot parse
        place = file.place if isinstance(file, _CountedLines) else name
        raise LogError(f"{place}: cannot be read as {reader[:3]} log: {error}") from error
