# SPDX-License-Identifier: Apache-2.0
"""Messages of a stamp, some strings, and a body of fixed size."""

from __future__ import annotations

from struct import Struct, error
from typing import Any

from safety_island.messages import wire
from safety_island.messages.codec import to_little_endian
from safety_island.messages.strings import LeadingStrings
from safety_island.messages.wire import CDR_LE, HEADER_SIZE, Time

_TIME = Struct("<iI")
_STRINGS = HEADER_SIZE + _TIME.size


def little_endian(data: bytes, type_name: str) -> bytes:
    """Return ``data``, turned into little-endian CDR when they are big-endian."""
    if data[:2] == CDR_LE and len(data) >= HEADER_SIZE:
        return data
    wire.is_little_endian(data, type_name)
    return to_little_endian(type_name, data)


def of_size(data: bytes, size: int, type_name: str) -> bytes:
    """Return ``data`` as little-endian CDR that fills ``size`` up to padding, else DecodeError."""
    if len(data) == size and data[:2] == CDR_LE:
        return data
    data = little_endian(data, type_name)
    wire.check_end(data, size, type_name)
    return data


def decode_stamp(data: bytes, type_name: str) -> Time:
    """Return the stamp that stands first in a message."""
    try:
        return tuple.__new__(Time, _TIME.unpack_from(data, HEADER_SIZE))
    except error:
        raise wire.truncated(type_name, HEADER_SIZE + _TIME.size, len(data)) from None


class Framed:
    """Reads such messages. One with the strings of the message before is read in one stroke.

    ``texts`` are the strings that were read last. ``body`` has the letters of ``struct``.
    """

    def __init__(self, type_name: str, strings: int, body: str) -> None:
        self.texts: tuple[str, ...] = ()
        self._type_name = type_name
        self._strings = LeadingStrings(type_name, strings)
        self._letters, self._body = body, Struct(f"<{body}")
        self._known: bytes | None = None
        self._end = _STRINGS
        self._size = 0
        self._whole = self._body

    def read(self, data: bytes) -> tuple[Any, ...]:
        """Return seconds and nanoseconds of the stamp, then the values of the body.

        Raises DecodeError when the data are not such a message.
        """
        is_alike = data[_STRINGS : self._end] == self._known and len(data) == self._size
        if is_alike and data[:2] == CDR_LE:
            return self._whole.unpack(data)
        return self._read_anew(little_endian(data, self._type_name))

    def _read_anew(self, data: bytes) -> tuple[Any, ...]:
        stamp = decode_stamp(data, self._type_name)
        end = self._strings.read(data)
        start = wire.aligned(end, 8)
        size = start + self._body.size
        wire.check_end(data, size, self._type_name)
        self.texts, self._known = self._strings.texts, bytes(data[_STRINGS:end])
        self._end, self._size = end, size
        self._whole = Struct(f"<{HEADER_SIZE}xiI{start - _STRINGS}x{self._letters}")
        return *stamp, *self._body.unpack_from(data, start)
