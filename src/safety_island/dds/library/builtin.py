# SPDX-License-Identifier: Apache-2.0
"""What discovery found: the C library's built-in topics of publications and subscriptions."""

from __future__ import annotations

import ctypes as ct
from typing import Any, NamedTuple

from safety_island.dds.errors import DdsError
from safety_island.dds.library.entity import checked, guid_of, handle_of
from safety_island.dds.library.find import OPTION
from safety_island.dds.library.layouts import ALIVE, EndpointData, SampleInfo
from safety_island.dds.library.loading import loaded
from safety_island.dds.library.policies import read_qos, read_user_data
from safety_island.dds.qos import Qos

BATCH = 256


class RawEndpoint(NamedTuple):
    """One event of discovery: an endpoint that appeared or changed, or (not ``alive``) left."""

    guid: bytes
    participant: bytes
    topic: str
    type_name: str
    qos: Qos
    user_data: bytes
    alive: bool
    handle: int = 0
    """The ``publication_handle`` of its samples."""
    lives: int = 0
    """How often it had left before, as far as the library remembers."""


class BuiltinReader:
    """Reads one of the two built-in topics (``layouts.PUBLICATIONS``, ``SUBSCRIPTIONS``)."""

    def __init__(self, participant: int, topic: int) -> None:
        made = loaded().dds_create_reader(participant, topic, None, None)
        self.entity = checked(made, "no reader of discovery")
        self._samples: Any = (ct.c_void_p * BATCH)()
        self._infos = (SampleInfo * BATCH)()

    def take(self) -> list[RawEndpoint]:
        """Take up to ``BATCH`` events, oldest first; DdsError with the library's return code."""
        samples, infos = self._samples, self._infos
        samples[0] = None  # the library lends its own memory
        count = loaded().dds_take(self.entity, samples, infos, BATCH, BATCH)
        if not checked(count, "reading discovery failed"):
            return []
        try:
            return [_endpoint(_data(samples[i]), infos[i]) for i in range(count)]
        finally:
            loaded().dds_return_loan(self.entity, samples, count)

    def check_layouts(self, participant: int, endpoint: int) -> None:
        """Raise DdsError unless the library describes this endpoint of ours as is expected.

        Only numbers are compared; no pointer of an unknown structure is followed.
        """
        samples, infos, handle = self._samples, self._infos, handle_of(endpoint)
        samples[0] = None
        count = loaded().dds_read_instance(self.entity, samples, infos, 1, 1, handle)
        expected = (guid_of(endpoint), guid_of(participant), handle_of(participant), handle, True)
        if count != 1 or _numbers(_data(samples[0]), infos[0]) != expected:
            raise DdsError(
                f"{loaded().path}: the structures of this libddsc are not known; expected one of"
                f" CycloneDDS 0.10 or 11, name it with {OPTION} PATH"
            )
        loaded().dds_return_loan(self.entity, samples, count)


def matched_writer(reader: int, handle: int) -> bytes | None:
    """Return the GUID (16 bytes) of a writer that the reader is matched with, by its handle."""
    library = loaded()
    found = library.dds_get_matched_publication_data(reader, handle)
    if not found:
        return None
    try:
        return bytes(found.contents.key.bytes)
    finally:
        library.dds_builtintopic_free_endpoint(found)


def _data(address: int) -> EndpointData:
    return EndpointData.from_address(address)


def _numbers(data: EndpointData, info: SampleInfo) -> tuple[bytes, bytes, int, int, bool]:
    key, participant = bytes(data.key.bytes), bytes(data.participant_key.bytes)
    handle = data.participant_instance_handle
    return key, participant, handle, info.instance_handle, info.valid_data


def _endpoint(data: EndpointData, info: SampleInfo) -> RawEndpoint:
    known = info.valid_data and data.qos
    return RawEndpoint(
        guid=bytes(data.key.bytes),
        participant=bytes(data.participant_key.bytes),
        topic=_text(data.topic_name),
        type_name=_text(data.type_name),
        qos=read_qos(data.qos) if known else Qos(),
        user_data=read_user_data(data.qos) if known else b"",
        alive=info.valid_data and info.instance_state == ALIVE,
        handle=info.instance_handle,
        lives=info.disposed_generation_count,
    )


def _text(name: bytes | None) -> str:
    return (name or b"").decode("utf-8", "replace")
