# SPDX-License-Identifier: Apache-2.0
"""Opens a log: packed or not, in the encoding that its first bytes name; tells which kind it is."""

from __future__ import annotations

import bz2
import codecs
import gzip
import io
import lzma
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from enum import StrEnum
from pathlib import PurePath
from typing import BinaryIO, TextIO, cast

from safety_island.can.log_lines import CUT
from safety_island.errors import IslandError

_PACKED: dict[bytes, Callable[..., object]] = {
    b"\x1f\x8b": gzip.open,
    b"BZh": bz2.open,
    b"\xfd7zXZ\x00": lzma.open,
}
_PACKED_SUFFIXES = (".gz", ".bz2", ".xz")
_UNREADABLE = {
    b"PK\x03\x04": "it is packed as ZIP; unpack it first",
    b"7z\xbc\xaf": "it is packed as 7z; unpack it first",
    b"\x28\xb5\x2f\xfd": "it is packed by zstd; unpack it first",
    b"MDF     ": "it is an MDF (MF4) log; convert it to BLF or ASC first",
}
_ENCODINGS = {
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}
_HEAD = 64
LONGEST_LINE = 1 << 16
"""Characters of a line; a device or another kind of file may have no end of a line at all."""


class LogError(IslandError):
    """A log that cannot be read."""

    exit_code = 2  # as for a recording: 1 is what a log that was read has shown


class LogKind(StrEnum):
    """The format of a log; the value is python-can's reader, or who writes it."""

    CANDUMP = "candump"
    ASC = "ASCReader"
    BLF = "BLFReader"
    CSV = "CSVReader"
    TRC = "TRCReader"


_SUFFIXES = {f".{kind.name.lower()}": kind for kind in LogKind if kind is not LogKind.CANDUMP}
_BEGINNINGS = {
    "LOGG": LogKind.BLF,
    "date ": LogKind.ASC,
    ";": LogKind.TRC,
    "timestamp,": LogKind.CSV,
    "(": LogKind.CANDUMP,
}


def _head(file: BinaryIO) -> bytes:
    """The first bytes, which stay there to be read."""
    return cast(io.BufferedReader, file).peek(_HEAD)[:_HEAD]


def unpacked(file: BinaryIO, name: str) -> BinaryIO:
    """Return what a file holds, unpacked when it is packed. Raises LogError, OSError."""
    head = _head(file)
    if not head:
        raise LogError(f"{name}: is empty, expected a log of 'candump -L' or python-can")
    for magic, why in _UNREADABLE.items():
        if head.startswith(magic):
            raise LogError(f"{name}: cannot be read: {why}")
    for magic, opener in _PACKED.items():
        if head.startswith(magic):
            return cast(BinaryIO, opener(file, "rb"))
    return file


def kind_of(file: BinaryIO, name: str) -> LogKind:
    """Tell the format by what a file begins with, else by its name. Raises LogError, OSError."""
    try:
        head = _head(file)
    except CUT as error:
        raise LogError(f"{name}: is packed and cut or damaged: {error}") from error
    text = head.decode(_encoding(head), errors="replace").lstrip()
    for beginning, kind in _BEGINNINGS.items():
        if text.lower().startswith(beginning.lower()):
            return kind
    suffixes = PurePath(name).suffixes[-2:]
    if suffixes and suffixes[-1].lower() in _PACKED_SUFFIXES:
        suffixes.pop()
    return _SUFFIXES.get(suffixes[-1].lower(), LogKind.CANDUMP) if suffixes else LogKind.CANDUMP


def lines_of(text: TextIO, name: str) -> Iterator[str]:
    """Yield the lines of a text. Raises LogError for one without an end, as a device has."""
    number = 0
    while line := text.readline(LONGEST_LINE):
        number += 1
        if len(line) == LONGEST_LINE:
            raise LogError(f"{name}:{number}: a line without an end, expected a CAN log")
        yield line


@contextmanager
def as_text(file: BinaryIO) -> Iterator[TextIO]:
    """Give a file as text; what is none becomes replacement characters."""
    text = io.TextIOWrapper(file, encoding=_encoding(_head(file)), errors="replace")
    try:
        yield text
    finally:
        text.detach()  # who opened the file closes it


def _encoding(head: bytes) -> str:
    for mark, encoding in _ENCODINGS.items():
        if head.startswith(mark):
            return encoding
    return "utf-8"
