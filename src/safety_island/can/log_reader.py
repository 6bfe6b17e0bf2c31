# SPDX-License-Identifier: Apache-2.0
"""Reads CAN logs: ``candump`` here, Vector and PEAK formats and CSV through python-can."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

from safety_island.can.candump import LogEntry, parse_line
from safety_island.can.log_files import LogError, LogKind, as_text, kind_of, lines_of, unpacked
from safety_island.can.log_lines import END_OF_HEADER, AscLines, LogLines, LogNotes, length_is_wrong
from safety_island.command.frames import COMMAND_IDS, FRAME_BYTES

__all__ = ["STANDARD_INPUT", "LogError", "LogNotes", "read_log"]

STANDARD_INPUT = "-"
_EXPECTED = (
    "expected a line of 'candump -L' like '(1700000000.123456) can0 100#48E80100E05EF8FF', or a "
    "log of python-can (.asc, .blf, .csv, .trc)"
)
_COUNTED_FROM_ONE = (LogKind.ASC, LogKind.BLF)
"""Formats whose channels python-can gives as one less than they are."""

_HEADS = {LogKind.ASC: END_OF_HEADER, LogKind.CSV: "\n"}
"""What a reader takes for the header when it begins again in the middle."""


def read_log(name: str, notes: LogNotes | None = None) -> Iterator[LogEntry]:
    """Yield the entries of a log, also of a packed one; ``-`` is standard input.

    What cannot be read is left out and goes to ``notes``. Raises LogError, which names file and
    line, when there is no frame at all.
    """
    shown = "standard input" if name == STANDARD_INPUT else name
    notes = notes or LogNotes(shown)
    is_empty = True
    try:
        for entry in _entries(name, shown, notes):
            is_empty = False
            yield entry
    except OSError as error:
        if is_empty:
            raise LogError(f"{shown}: cannot be read: {error.strerror or error}") from error
        notes.cut(error.strerror or error)
    if is_empty:
        raise LogError(f"{notes.first or f'{shown}: holds no CAN frame'}, {_EXPECTED}")


def _entries(name: str, shown: str, notes: LogNotes) -> Iterator[LogEntry]:
    if name == STANDARD_INPUT:
        yield from _read(sys.stdin.buffer, shown, notes)
        return
    with Path(name).open("rb") as file:
        yield from _read(file, shown, notes)


def _read(packed: BinaryIO, name: str, notes: LogNotes) -> Iterator[LogEntry]:
    file = unpacked(packed, name)
    kind = kind_of(file, name)
    if kind is LogKind.BLF:
        yield from _blf(file, name, notes)
        return
    with as_text(file) as text:
        if kind is LogKind.CANDUMP:
            yield from _candump(LogLines(lines_of(text, name), notes))
        else:
            reading = AscLines if kind is LogKind.ASC else LogLines
            lines = reading(lines_of(text, name), notes)
            yield from _text_of_python_can(kind, lines)


def _candump(lines: LogLines) -> Iterator[LogEntry]:
    for line in lines:
        entry = parse_line(line)
        if entry is None or (not line.endswith("\n") and _lacks_bytes(entry)):
            if line.strip():
                lines.leave_out()
            continue
        yield entry


def _lacks_bytes(entry: LogEntry) -> bool:
    """Whether a frame of a command is too short, as when its line was cut between two bytes."""
    frame = entry.frame
    return (
        frame is not None and frame.arbitration_id in COMMAND_IDS and len(frame.data) < FRAME_BYTES
    )


def _text_of_python_can(kind: LogKind, lines: LogLines) -> Iterator[LogEntry]:
    """Read on after a line that the reader of python-can cannot parse."""
    import can

    reader = getattr(can, kind)(lines)
    reached = -1
    while lines.number > reached:
        reached = lines.number
        try:
            for message in reader:
                if length_is_wrong(message):
                    lines.leave_out()
                else:
                    yield _entry_of(message, kind)
            return
        except LogError:
            raise
        except Exception:  # each reader has exceptions of its own for what it cannot parse
            lines.leave_out()
        if kind in _HEADS:
            lines.put_in(_HEADS[kind])


def _blf(file: BinaryIO, name: str, notes: LogNotes) -> Iterator[LogEntry]:
    import can

    whole = _Counted(file)
    is_empty = True
    try:
        reader = can.BLFReader(whole)  # type: ignore[arg-type]
        for message in reader:
            is_empty = False
            yield _entry_of(message, LogKind.BLF)
        if whole.size < reader.file_size:
            notes.cut(f"{whole.size} of {reader.file_size} bytes are there")
    except Exception as error:  # struct, zlib, its own, and what damaged numbers lead to
        if is_empty:
            raise LogError(f"{name}: cannot be read as BLF log: it is cut or damaged") from error
        notes.cut(error)


class _Counted:
    """A binary file that counts what was read of it."""

    def __init__(self, file: BinaryIO) -> None:
        self.size = 0
        self._file = file

    def read(self, size: int) -> bytes:
        """Read up to so many bytes."""
        data = self._file.read(size)
        self.size += len(data)
        return data

    def close(self) -> None:
        """Who opened the file closes it."""


def _entry_of(message: Any, kind: LogKind) -> LogEntry:
    from safety_island.can.python_can_bus import entry_of

    entry = entry_of(message)
    if kind in _COUNTED_FROM_ONE and isinstance(message.channel, int):
        return entry._replace(channel=str(message.channel + 1))
    return entry
