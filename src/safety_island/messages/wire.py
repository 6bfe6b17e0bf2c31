# SPDX-License-Identifier: Apache-2.0
"""Plain CDR (XCDR1): the encapsulation header, strings, time, and what every decoder checks."""

from __future__ import annotations

from typing import NamedTuple

from safety_island.kernel.cdr import (
    CDR_BE,
    CDR_LE,
    HEADER_SIZE,
    MAX_PADDING,
    NANOSECONDS,
    DecodeReason,
)
from safety_island.messages.errors import DecodeError, EncodeError

HEADER_LE = b"\x00\x01\x00\x00"
"""Encapsulation header of plain little-endian CDR; alignment counts from the byte after it."""

_KINDS = {
    b"\x00\x02": "PL_CDR (big endian)",
    b"\x00\x03": "PL_CDR (little endian)",
    b"\x00\x06": "XCDR2 (big endian)",
    b"\x00\x07": "XCDR2 (little endian)",
    b"\x00\x08": "delimited XCDR2 (big endian)",
    b"\x00\x09": "delimited XCDR2 (little endian)",
    b"\x00\x0a": "PL_CDR2 (big endian)",
    b"\x00\x0b": "PL_CDR2 (little endian)",
}


class Time(NamedTuple):
    """A stamp as it is on the wire: ``sec`` may be negative, ``nanosec`` may be out of range."""

    sec: int = 0
    nanosec: int = 0

    @property
    def seconds(self) -> float:
        """The stamp [s]; today's stamps are exact to 0.24 us."""
        return self.sec + self.nanosec * 1e-9

    @property
    def nanoseconds(self) -> int:
        """The stamp [ns], exact."""
        return self.sec * NANOSECONDS + self.nanosec

    @classmethod
    def from_nanoseconds(cls, nanoseconds: int) -> Time:
        """Return the stamp of a number of nanoseconds since the epoch."""
        return cls(*divmod(nanoseconds, NANOSECONDS))

    @classmethod
    def from_seconds(cls, seconds: float) -> Time:
        """Return the stamp nearest to ``seconds`` [s]."""
        whole = int(seconds // 1)
        nanosec = round((seconds - whole) * NANOSECONDS)
        return cls(whole + 1, 0) if nanosec == NANOSECONDS else cls(whole, nanosec)


def aligned(offset: int, size: int) -> int:
    """Return the first place at or after ``offset`` that is a multiple of ``size``.

    Offsets count from the start of the data; alignment counts from the end of the header.
    """
    return offset + (HEADER_SIZE - offset) % size


def is_little_endian(data: bytes, type_name: str) -> bool:
    """Read the encapsulation header: True for little, False for big endian plain CDR.

    Raises DecodeError for every other encapsulation and for data without a whole header.
    """
    if len(data) < HEADER_SIZE:
        raise truncated(type_name, HEADER_SIZE, len(data))
    kind = bytes(data[:2])
    if kind not in (CDR_LE, CDR_BE):
        raise other_encapsulation(type_name, data)
    return kind == CDR_LE


def other_encapsulation(type_name: str, data: bytes) -> DecodeError:
    """Return the error for a header that does not announce plain CDR."""
    kind = bytes(data[:2])
    found = _KINDS.get(kind, f"unknown encapsulation 0x{kind.hex()}")
    detail = f"found {found}, expected plain CDR (XCDR1)"
    return DecodeError(DecodeReason.ENCAPSULATION, type_name, detail)


def truncated(type_name: str, needed: int, available: int) -> DecodeError:
    """Return the error for data that end too early."""
    detail = f"{needed} bytes are needed, {available} are there"
    return DecodeError(DecodeReason.TRUNCATED, type_name, detail)


def trailing(type_name: str, surplus: int) -> DecodeError:
    """Return the error for ``surplus`` bytes behind a message."""
    return DecodeError(DecodeReason.TRAILING, type_name, f"{surplus} bytes follow the message")


def no_string(type_name: str) -> DecodeError:
    """Return the error for a string that is none."""
    detail = "a string is not UTF-8 that ends at its first NUL"
    return DecodeError(DecodeReason.STRING, type_name, detail)


def no_boolean(type_name: str, value: int) -> DecodeError:
    """Return the error for a boolean that is neither 0 nor 1."""
    return DecodeError(DecodeReason.BOOLEAN, type_name, f"{value} is no boolean")


def check_end(data: bytes, end: int, type_name: str) -> None:
    """Raise DecodeError unless the message that ends at ``end`` fills ``data`` up to padding."""
    surplus = len(data) - end
    if surplus < 0:
        raise truncated(type_name, end, len(data))
    if surplus > MAX_PADDING:
        raise trailing(type_name, surplus)


def string_body(data: bytes, start: int, length: int, type_name: str) -> str:
    """Return the text of ``length`` bytes, the closing NUL counted; length 0 is an empty string."""
    end = start + length
    if end > len(data):
        raise truncated(type_name, end, len(data))
    if length == 0:
        return ""
    if data.find(0, start, end) != end - 1:
        raise no_string(type_name)
    try:
        return str(data[start : end - 1], "utf-8")
    except UnicodeDecodeError:
        raise no_string(type_name) from None


def string_bytes(text: str) -> bytes:
    """Return the bytes of a string with its closing NUL, without the length before it."""
    if "\0" in text:
        raise EncodeError(f"a string must not contain NUL: {text!r}")
    return text.encode("utf-8") + b"\0"


def read_bool(value: int, type_name: str) -> bool:
    """Return the boolean of one byte; DecodeError unless it is 0 or 1."""
    if value > 1:
        raise no_boolean(type_name, value)
    return value == 1
