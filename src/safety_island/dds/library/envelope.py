# SPDX-License-Identifier: Apache-2.0
"""Serialized bytes for the ``dds_writecdr`` of release 0.10, which says nothing of its types.

It takes a serialized sample of any type and makes one of the writer's type from its bytes, checked
(``ddsi/ddsi_serdata.h``). Which functions give those bytes is in the sample's head, whose layout
that header fixes: here those that the library has for plain CDR. Where they look for the bytes
depends on how the library was built; they are asked.
"""

from __future__ import annotations

import ctypes as ct
import struct

from safety_island.dds.errors import DdsError
from safety_island.dds.library.layouts import DATA

_OPERATIONS, _VERSION = "ddsi_serdata_ops_cdr_nokey", "ddsi_sertype_v0"
_REFERENCES = 1 << 30
"""More than are ever given back: the library does not free the memory, which is Python's."""
_WORD = 4
_ROOM = 256


class Head(ct.Structure):
    """``struct ddsi_serdata`` as far as its header fixes it."""

    _fields_ = (
        ("operations", ct.c_void_p),
        ("hash", ct.c_uint32),
        ("references", ct.c_uint32),
        ("kind", ct.c_int),
        ("type", ct.c_void_p),
        ("timestamp", ct.c_int64),
        ("status", ct.c_uint32),
        ("written", ct.c_int64),
    )


class Envelope:
    """Puts serialized bytes into the form that a library takes.

    Raises DdsError for a library whose samples are of another kind.
    """

    def __init__(self, library: ct.CDLL) -> None:
        self._type_operations = (ct.c_void_p * 16)(_address(library, _VERSION))
        self._type = (ct.c_void_p * 16)(ct.addressof(self._type_operations))
        self._operations = _address(library, _OPERATIONS)
        self._length, self._bytes = self._places(library)

    def around(self, data: bytes) -> ct.Array[ct.c_char]:
        """Return memory that ``dds_writecdr`` takes; it may go when that returned."""
        memory = self._empty(max(_ROOM, self._bytes + len(data)))
        struct.pack_into("=I", memory, self._length, len(data) - _WORD)
        ct.memmove(ct.byref(memory, self._bytes), data, len(data))
        return memory

    def _empty(self, size: int) -> ct.Array[ct.c_char]:
        memory = ct.create_string_buffer(size)
        head = Head.from_buffer(memory)
        head.operations, head.references, head.kind = self._operations, _REFERENCES, DATA
        head.type = ct.addressof(self._type)
        return memory

    def _places(self, library: ct.CDLL) -> tuple[int, int]:
        """Return where the library looks for the length behind the first word, and for that."""
        memory = self._empty(_ROOM)
        places = range(ct.sizeof(Head), _ROOM, _WORD)
        for place in places:  # each word says where it is
            struct.pack_into("=I", memory, place, place)
        word = ct.create_string_buffer(_WORD)
        length = library.ddsi_serdata_size(memory) - _WORD
        library.ddsi_serdata_to_ser(memory, ct.c_size_t(0), ct.c_size_t(_WORD), word)
        (start,) = struct.unpack("=I", word.raw)
        if length not in places or start not in places or start <= length:
            raise DdsError(f"{library._name}: how this libddsc keeps serialized samples is unknown")
        return length, start


def _address(library: ct.CDLL, name: str) -> int | None:
    return ct.cast(getattr(library, name), ct.c_void_p).value
