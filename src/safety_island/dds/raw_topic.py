# SPDX-License-Identifier: Apache-2.0
"""Topics whose samples are serialized bytes, through the library's public C functions.

A topic of a registered type has the library check every sample and swap a big-endian one; of an
unknown type samples pass through as bytes. Both match by the name of the type alone: see
``types.py``.
"""

from __future__ import annotations

import ctypes as ct
from typing import Any

from cyclonedds.core import Entity
from cyclonedds.domain import DomainParticipant
from cyclonedds.internal import DDS, dds_c_t
from cyclonedds.topic import Topic

from safety_island.dds.binding import ANY, RETCODE_BAD_PARAMETER, RawSample, strerror
from safety_island.dds.errors import DdsError
from safety_island.dds.types import Descriptor, descriptor_of, opaque_descriptor

_library: Any = DDS._dll_handle
_DATA = 2
_NO_CONTENT = bytes(1)
"""In place of a sample where only its key counts, and it has none."""
_BATCH = 64
_MINIMUM_WRITE = 4
"""The C layer reads a header of this many bytes without looking whether it is there."""


class _Vector(ct.Structure):
    """``struct iovec``."""

    _fields_ = (("base", ct.c_char_p), ("length", ct.c_size_t))


def _function(name: str, result: Any, *arguments: Any, waits: bool = False) -> Any:
    """Return a C function with a prototype of its own: cyclonedds sets others on the library.

    Other Python threads run during one that ``waits``; the others are too short for a change of
    threads, which a busy one would answer late.
    """
    prototype = ct.CFUNCTYPE if waits else ct.PYFUNCTYPE
    return prototype(result, *arguments)((name, _library))


_entity = dds_c_t.entity
_create_topic = _function(
    "dds_create_topic",
    _entity,
    _entity,
    ct.POINTER(Descriptor),
    ct.c_char_p,
    ct.c_void_p,
    ct.c_void_p,
)
_take_cdr = _function(
    "dds_takecdr",
    ct.c_int32,
    _entity,
    ct.POINTER(ct.c_void_p),
    ct.c_uint32,
    ct.POINTER(dds_c_t.sample_info),
    ct.c_uint32,
)
_sertype_of = _function("dds_get_entity_sertype", ct.c_int32, _entity, ct.POINTER(ct.c_void_p))
_write_cdr = _function("dds_writecdr", ct.c_int32, _entity, ct.c_void_p, waits=True)
_dispose = _function("dds_dispose", ct.c_int32, _entity, ct.c_char_p)
_from_bytes = _function(
    "ddsi_serdata_from_ser_iov",
    ct.c_void_p,
    ct.c_void_p,
    ct.c_int,
    ct.c_size_t,
    ct.POINTER(_Vector),
    ct.c_size_t,
)
_size = _function("ddsi_serdata_size", ct.c_uint32, ct.c_void_p)
_to_bytes = _function(
    "ddsi_serdata_to_ser", None, ct.c_void_p, ct.c_size_t, ct.c_size_t, ct.c_void_p
)
_release = _function("ddsi_serdata_unref", None, ct.c_void_p)


class RawTopic(Topic[Any]):
    """A DDS topic of a ROS type."""

    def __init__(self, participant: DomainParticipant, dds_topic: str, type_name: str) -> None:
        described, name = self.descriptor(type_name), dds_topic.encode("ascii")
        Entity.__init__(self, _create_topic(participant._ref, described, name, None, None))
        self.data_type: Any = None
        self._keepalive_entities = [participant]

    descriptor = staticmethod(descriptor_of)


class OpaqueTopic(RawTopic):
    """A DDS topic with a ROS type name whose samples nobody checks."""

    descriptor = staticmethod(opaque_descriptor)


class Room:
    """Where the library puts the samples of one reader, used again each time."""

    def __init__(self) -> None:
        self.data = (ct.c_void_p * _BATCH)()
        self.infos = (dds_c_t.sample_info * _BATCH)()


def take(reader: int, limit: int, room: Room) -> list[RawSample]:
    """Take up to ``limit`` samples, oldest first; DdsError with the library's return code."""
    found: list[RawSample] = []
    data, infos = room.data, room.infos
    while len(found) < limit:
        batch = min(_BATCH, limit - len(found))
        count = _take_cdr(reader, data, batch, infos, ANY)
        if count < 0:
            raise DdsError(f"taking samples failed: {strerror(count)}")
        found += [_sample(data[i], infos[i]) for i in range(count)]
        if count < batch:
            break
    return found


def write(writer: int, data: bytes) -> int:
    """Write serialized CDR (header included) and return 0 or a negative return code."""
    if len(data) < _MINIMUM_WRITE:
        return RETCODE_BAD_PARAMETER
    data = filled(data)
    sertype = ct.c_void_p()
    code: int = _sertype_of(writer, sertype)
    if code < 0:
        return code
    vector = _Vector(data, len(data))
    serialized = _from_bytes(sertype, _DATA, 1, vector, len(data))
    if not serialized:
        return RETCODE_BAD_PARAMETER
    code = _write_cdr(writer, serialized)
    return code


def dispose(writer: int) -> int:
    """Dispose what a writer of a topic without key has sent; 0 or a negative return code."""
    code: int = _dispose(writer, _NO_CONTENT)
    return code


def filled(data: bytes) -> bytes:
    """Return the data with zeros behind, up to a multiple of four bytes."""
    surplus = len(data) & 3
    return data + bytes(4 - surplus) if surplus else data


def _sample(data: int | None, info: Any) -> RawSample:
    size = _size(data)
    memory = ct.create_string_buffer(size)
    _to_bytes(data, 0, size, memory)
    _release(data)
    return RawSample(
        memory.raw,
        info.valid_data,
        info.source_timestamp,
        info.publication_handle,
        info.instance_state,
    )
