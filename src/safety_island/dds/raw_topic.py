# SPDX-License-Identifier: Apache-2.0
"""Topics whose samples are serialized bytes, through the library's public C functions.

A topic of a registered type has the library check every sample and swap a big-endian one; of an
unknown type samples pass through as bytes. Both match by the name of the type alone: see
``types.py``.
"""

from __future__ import annotations

import ctypes as ct
from typing import NamedTuple

from safety_island.dds.errors import DdsError
from safety_island.dds.library.entity import RETCODE_BAD_PARAMETER, RETCODE_ERROR, checked, strerror
from safety_island.dds.library.layouts import (
    ALIVE,
    ANY,
    DATA,
    DISPOSED,
    NO_WRITERS,
    SampleInfo,
    Vector,
)
from safety_island.dds.library.loading import Library, loaded
from safety_island.dds.library.release import Release
from safety_island.dds.types import descriptor_of, opaque_descriptor

_NO_CONTENT = bytes(1)
"""In place of a sample where only its key counts, and it has none."""
_BATCH = 64
_MINIMUM_WRITE = 4
"""The C layer reads a header of this many bytes without looking whether it is there."""


class RawSample(NamedTuple):
    """One taken sample; without ``valid`` it only tells that an instance or a writer went away."""

    data: bytes
    valid: bool
    source_timestamp_ns: int
    publication_handle: int
    state: int = ALIVE
    """What became of the topic's instance by now."""

    @property
    def is_alive(self) -> bool:
        """Whether what was said last still counts."""
        return self.state == ALIVE

    @property
    def is_disposed(self) -> bool:
        """Whether a publisher has disposed what was said last."""
        return self.state == DISPOSED

    @property
    def is_orphaned(self) -> bool:
        """Whether none of those who published is alive any more."""
        return self.state == NO_WRITERS


class RawTopic:
    """A DDS topic of a ROS type. Raises DdsError when the library refuses it."""

    descriptor = staticmethod(descriptor_of)

    def __init__(self, participant: int, name: str, type_name: str) -> None:
        self.name = name
        described = self.descriptor(type_name)
        made = loaded().dds_create_topic(participant, described, name.encode(), None, None)
        self.entity = checked(made, f"topic {name} of {type_name} was refused")


class OpaqueTopic(RawTopic):
    """A DDS topic with a ROS type name whose samples nobody checks."""

    descriptor = staticmethod(opaque_descriptor)


class Room:
    """Where the library puts the samples of one reader, used again each time."""

    def __init__(self) -> None:
        self.data = (ct.c_void_p * _BATCH)()
        self.infos = (SampleInfo * _BATCH)()


def take(reader: int, limit: int, room: Room) -> list[RawSample]:
    """Take up to ``limit`` samples, oldest first; DdsError with the library's return code."""
    found: list[RawSample] = []
    data, infos, library = room.data, room.infos, loaded()
    while len(found) < limit:
        batch = min(_BATCH, limit - len(found))
        count = library.dds_takecdr(reader, data, batch, infos, ANY)
        if count < 0:
            raise DdsError(f"taking samples failed: {strerror(count)}")
        found += [_sample(library, data[i], infos[i]) for i in range(count)]
        if count < batch:
            break
    return found


def write(writer: int, data: bytes) -> int:
    """Write serialized CDR (header included) and return 0 or a negative return code."""
    if len(data) < _MINIMUM_WRITE:
        return RETCODE_BAD_PARAMETER
    library = loaded()
    if library.release is Release.V0_10:
        code: int = library.dds_writecdr(writer, library.envelope.around(filled(data)))
        return RETCODE_BAD_PARAMETER if code == RETCODE_ERROR else code
    return _write_as_type(library, writer, filled(data))


def _write_as_type(library: Library, writer: int, data: bytes) -> int:
    sertype = ct.c_void_p()
    code: int = library.dds_get_entity_sertype(writer, sertype)
    if code < 0:
        return code
    vector = Vector(data, len(data))
    serialized = library.ddsi_serdata_from_ser_iov(sertype, DATA, 1, vector, len(data))
    if not serialized:
        return RETCODE_BAD_PARAMETER
    code = library.dds_writecdr(writer, serialized)
    return code


def dispose(writer: int) -> int:
    """Dispose what a writer of a topic without key has sent; 0 or a negative return code."""
    code: int = loaded().dds_dispose(writer, _NO_CONTENT)
    return code


def filled(data: bytes) -> bytes:
    """Return the data with zeros behind, up to a multiple of four bytes."""
    surplus = len(data) & 3
    return data + bytes(4 - surplus) if surplus else data


def _sample(library: Library, data: int | None, info: SampleInfo) -> RawSample:
    size = library.ddsi_serdata_size(data)
    memory = ct.create_string_buffer(size)
    library.ddsi_serdata_to_ser(data, 0, size, memory)
    library.ddsi_serdata_unref(data)
    return RawSample(
        memory.raw,
        info.valid_data,
        info.source_timestamp,
        info.publication_handle,
        info.instance_state,
    )
