# SPDX-License-Identifier: Apache-2.0
"""Plain CDR (XCDR1) in numbers: what the generic codec and the kernels that decode both go by."""

from __future__ import annotations

from enum import IntEnum

CDR_LE = b"\x00\x01"
CDR_BE = b"\x00\x00"
HEADER_SIZE = 4
"""Bytes of the encapsulation header; alignment counts from the byte after it."""
MAX_PADDING = 3
"""RTPS pads a payload to a multiple of four bytes."""
NANOSECONDS = 1_000_000_000
"""In a second: a stamp is seconds and nanoseconds."""


class DecodeReason(IntEnum):
    """Why bytes were refused."""

    ENCAPSULATION = 0
    """The first four bytes do not announce plain CDR (XCDR1)."""
    TRUNCATED = 1
    """The bytes end inside a field, or a length says that more must come."""
    LENGTH = 2
    """A string or sequence is longer than its type or the receiver allows."""
    STRING = 3
    """A string lacks its closing NUL, has another before it, or is not UTF-8."""
    BOOLEAN = 4
    """A boolean is neither 0 nor 1."""
    TRAILING = 5
    """More bytes follow the message than padding explains."""
