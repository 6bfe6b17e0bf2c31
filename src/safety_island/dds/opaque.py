"""Topics whose type is not known: samples pass through as bytes.

The type has the right name and says nothing of its content, and no type information is announced:
peers then match by the name alone, as they do with every ROS 2 release. (A stand-in type with type
information would be compared with the peer's and refused.) The price: nobody checks the bytes, and
a big-endian sample of an unknown type cannot be told from a little-endian one.
Uses the library's public C functions through ctypes; other Python threads run meanwhile.
"""

from __future__ import annotations

import ctypes as ct
from typing import Any

from cyclonedds.core import Entity
from cyclonedds.domain import DomainParticipant
from cyclonedds.internal import DDS, dds_c_t
from cyclonedds.topic import Topic

from safety_island.dds.binding import ANY, MINIMUM_WRITE, RETCODE_BAD_PARAMETER, RawSample, filled
from safety_island.dds.errors import DdsError
from safety_island.messages.registry import dds_type_name

_library: Any = DDS._dll_handle
_OP_ADDRESS_1_BYTE = 0x01010000
_OPERATIONS = (ct.c_uint32 * 3)(_OP_ADDRESS_1_BYTE, 0, 0)
_FIXED_SIZE = 1 << 3
_XCDR1 = 1
_DATA = 2
_NO_CONTENT = bytes(1)
"""A sample of the stand-in type."""
_BATCH = 64


class _Metadata(ct.Structure):
    _fields_ = (("data", ct.c_void_p), ("size", ct.c_uint32))


class _Descriptor(ct.Structure):
    """``dds_topic_descriptor_t`` of ddsc/dds_public_impl.h."""

    _fields_ = (
        ("size", ct.c_uint32),
        ("alignment", ct.c_uint32),
        ("flags", ct.c_uint32),
        ("key_count", ct.c_uint32),
        ("type_name", ct.c_char_p),
        ("keys", ct.c_void_p),
        ("operation_count", ct.c_uint32),
        ("operations", ct.POINTER(ct.c_uint32)),
        ("xml", ct.c_char_p),
        ("type_information", _Metadata),
        ("type_mapping", _Metadata),
        ("representations", ct.c_uint32),
    )


class _Vector(ct.Structure):
    """``struct iovec``."""

    _fields_ = (("base", ct.c_char_p), ("length", ct.c_size_t))


def _function(name: str, result: Any, *arguments: Any) -> Any:
    """Return a C function with a prototype of its own: cyclonedds sets others on the library."""
    return ct.CFUNCTYPE(result, *arguments)((name, _library))


_entity = dds_c_t.entity
_create_topic = _function(
    "dds_create_topic",
    _entity,
    _entity,
    ct.POINTER(_Descriptor),
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
_write_cdr = _function("dds_writecdr", ct.c_int32, _entity, ct.c_void_p)
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


class OpaqueTopic(Topic[Any]):
    """A DDS topic with a ROS type name and unknown content."""

    def __init__(self, participant: DomainParticipant, dds_topic: str, type_name: str) -> None:
        self._name = dds_type_name(type_name).encode("ascii")
        described = _Descriptor(
            size=1,
            alignment=1,
            flags=_FIXED_SIZE,
            type_name=self._name,
            operation_count=2,
            operations=_OPERATIONS,
            xml=b"",
            representations=_XCDR1,
        )
        name = dds_topic.encode("ascii")
        Entity.__init__(self, _create_topic(participant._ref, described, name, None, None))
        self.data_type: Any = None
        self._keepalive_entities = [participant]


def take(reader: int, limit: int) -> list[RawSample]:
    """Take up to ``limit`` samples, oldest first; DdsError with the library's return code."""
    found: list[RawSample] = []
    while len(found) < limit:
        batch = min(_BATCH, limit - len(found))
        data, infos = (ct.c_void_p * batch)(), (dds_c_t.sample_info * batch)()
        count = _take_cdr(reader, data, batch, infos, ANY)
        if count < 0:
            raise DdsError(f"taking samples failed ({count})")
        found += [_sample(data[i], infos[i]) for i in range(count)]
        if count < batch:
            break
    return found


def write(writer: int, data: bytes) -> int:
    """Write serialized CDR (header included) and return 0 or a negative return code."""
    if len(data) < MINIMUM_WRITE:
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
