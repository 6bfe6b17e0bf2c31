# SPDX-License-Identifier: Apache-2.0
"""Any registered message to CDR bytes and back, driven by its description.

For what is not hot: discovery data, tools, tests. The messages of a tick have codecs of their own
(``inputs``, ``outputs``), which this one is compared with.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from typing import Any

from safety_island.kernel.cdr import CDR_LE
from safety_island.messages import wire
from safety_island.messages.cdr_reader import Reader
from safety_island.messages.cdr_writer import Writer
from safety_island.messages.errors import EncodeError


def encode(type_name: str, message: Mapping[str, Any]) -> bytes:
    """Return little-endian plain CDR, header included; missing fields take their defaults.

    Arrays and sequences may be lists or NumPy arrays. Raises EncodeError for an unknown field or a
    value that its field cannot hold, UnknownTypeError for the type.
    """
    writer = Writer()
    try:
        writer.named(type_name, message)
    except (struct.error, TypeError, ValueError, OverflowError) as problem:
        raise EncodeError(f"{type_name}: {problem}") from None
    return bytes(writer.data)


def decode(type_name: str, data: bytes) -> dict[str, Any]:
    """Return the message as nested dicts; arrays of numbers are NumPy arrays.

    Accepts plain CDR of either byte order. Raises DecodeError for everything else; no length in the
    data makes it allocate more than the data themselves justify.
    """
    little = wire.is_little_endian(data, type_name)
    reader = Reader(data, little, type_name)
    message = reader.named(type_name)
    wire.check_end(data, reader.offset, type_name)
    return message


def default(type_name: str) -> dict[str, Any]:
    """Return a new message with every field at its default (zero, empty, False)."""
    return decode(type_name, encode(type_name, {}))


def to_little_endian(type_name: str, data: bytes) -> bytes:
    """Return the same message as little-endian CDR; DecodeError when it is no message."""
    return encode(type_name, decode(type_name, data))


def of_size(data: bytes, size: int, type_name: str) -> bytes:
    """Return ``data`` as little-endian CDR that fills ``size`` up to padding, else DecodeError."""
    if len(data) == size and data[:2] == CDR_LE:
        return data
    if not wire.is_little_endian(data, type_name):
        data = to_little_endian(type_name, data)
    wire.check_end(data, size, type_name)
    return data
