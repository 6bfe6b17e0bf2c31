# SPDX-License-Identifier: Apache-2.0
"""The functions of the C library that are used, each with its prototype."""

from __future__ import annotations

import ctypes as ct
from collections.abc import Mapping
from typing import Any, NamedTuple

from safety_island.dds.library.layouts import (
    DURATION,
    ENTITY,
    HANDLE,
    RETURN,
    Descriptor,
    EndpointData,
    Filter,
    Guid,
    SampleInfo,
    Vector,
)

_POINTER, _TEXT, _INT, _UINT, _BOOL = ct.c_void_p, ct.c_char_p, ct.c_int, ct.c_uint32, ct.c_bool
_SAMPLES, _INFOS = ct.POINTER(ct.c_void_p), ct.POINTER(SampleInfo)
_OUT_INT, _OUT_TIME = ct.POINTER(ct.c_int), ct.POINTER(DURATION)


class Prototype(NamedTuple):
    """Result and arguments of a C function."""

    result: Any
    arguments: tuple[Any, ...]
    holds: bool = False
    """Other Python threads stand still meanwhile: it is too short for a change of threads, which a
    busy one would answer late."""

    def bind(self, library: ct.CDLL, name: str) -> Any:
        """Return the function of a library; AttributeError when it has none."""
        make = ct.PYFUNCTYPE if self.holds else ct.CFUNCTYPE
        return make(self.result, *self.arguments)((name, library))


def _p(result: Any, *arguments: Any, holds: bool = False) -> Prototype:
    return Prototype(result, arguments, holds)


_ENTITIES = {
    "dds_create_domain": _p(ENTITY, _UINT, _TEXT),
    "dds_create_participant": _p(ENTITY, _UINT, _POINTER, _POINTER),
    "dds_create_topic": _p(ENTITY, ENTITY, ct.POINTER(Descriptor), _TEXT, _POINTER, _POINTER),
    "dds_create_reader": _p(ENTITY, ENTITY, ENTITY, _POINTER, _POINTER),
    "dds_create_writer": _p(ENTITY, ENTITY, ENTITY, _POINTER, _POINTER),
    "dds_create_readcondition": _p(ENTITY, ENTITY, _UINT),
    "dds_create_waitset": _p(ENTITY, ENTITY),
    "dds_waitset_attach": _p(RETURN, ENTITY, ENTITY, ct.c_ssize_t),
    "dds_waitset_detach": _p(RETURN, ENTITY, ENTITY),
    "dds_waitset_wait": _p(RETURN, ENTITY, _POINTER, ct.c_size_t, DURATION),
    "dds_delete": _p(RETURN, ENTITY),
    "dds_get_guid": _p(RETURN, ENTITY, ct.POINTER(Guid)),
    "dds_get_instance_handle": _p(RETURN, ENTITY, ct.POINTER(HANDLE)),
    "dds_set_topic_filter_extended": _p(RETURN, ENTITY, ct.POINTER(Filter)),
    "dds_domain_set_deafmute": _p(RETURN, ENTITY, _BOOL, _BOOL, DURATION),
}
_MATCHES = {
    "dds_get_matched_publications": _p(RETURN, ENTITY, _POINTER, ct.c_size_t, holds=True),
    "dds_get_matched_subscriptions": _p(RETURN, ENTITY, _POINTER, ct.c_size_t, holds=True),
    "dds_get_matched_publication_data": _p(ct.POINTER(EndpointData), ENTITY, HANDLE, holds=True),
    "dds_builtintopic_free_endpoint": _p(None, ct.POINTER(EndpointData), holds=True),
}
_SAMPLES_IN_AND_OUT = {
    "dds_read_instance": _p(RETURN, ENTITY, _SAMPLES, _INFOS, ct.c_size_t, _UINT, HANDLE),
    "dds_take": _p(RETURN, ENTITY, _SAMPLES, _INFOS, ct.c_size_t, _UINT, holds=True),
    "dds_return_loan": _p(RETURN, ENTITY, _SAMPLES, ct.c_int32, holds=True),
    "dds_takecdr": _p(RETURN, ENTITY, _SAMPLES, _UINT, _INFOS, _UINT, holds=True),
    "dds_writecdr": _p(RETURN, ENTITY, _POINTER),
    "dds_dispose": _p(RETURN, ENTITY, _TEXT, holds=True),
    "ddsi_serdata_from_ser_iov": _p(
        _POINTER, _POINTER, _INT, ct.c_size_t, ct.POINTER(Vector), ct.c_size_t, holds=True
    ),
    "ddsi_serdata_size": _p(_UINT, _POINTER, holds=True),
    "ddsi_serdata_to_ser": _p(None, _POINTER, ct.c_size_t, ct.c_size_t, _POINTER, holds=True),
    "ddsi_serdata_unref": _p(None, _POINTER, holds=True),
}
_POLICIES = {
    "dds_create_qos": _p(_POINTER),
    "dds_delete_qos": _p(None, _POINTER),
    "dds_free": _p(None, _POINTER, holds=True),
    "dds_qset_userdata": _p(None, _POINTER, _TEXT, ct.c_size_t),
    "dds_qset_reliability": _p(None, _POINTER, _INT, DURATION),
    "dds_qset_durability": _p(None, _POINTER, _INT),
    "dds_qset_durability_service": _p(
        None, _POINTER, DURATION, _INT, ct.c_int32, ct.c_int32, ct.c_int32, ct.c_int32
    ),
    "dds_qset_history": _p(None, _POINTER, _INT, ct.c_int32),
    "dds_qset_liveliness": _p(None, _POINTER, _INT, DURATION),
    "dds_qset_deadline": _p(None, _POINTER, DURATION),
    "dds_qset_lifespan": _p(None, _POINTER, DURATION),
    "dds_qset_ignorelocal": _p(None, _POINTER, _INT),
    "dds_qset_writer_data_lifecycle": _p(None, _POINTER, _BOOL),
    "dds_qset_data_representation": _p(None, _POINTER, _UINT, ct.POINTER(ct.c_int16)),
    "dds_qget_userdata": _p(
        _BOOL, _POINTER, ct.POINTER(ct.c_void_p), ct.POINTER(ct.c_size_t), holds=True
    ),
    "dds_qget_reliability": _p(_BOOL, _POINTER, _OUT_INT, _OUT_TIME, holds=True),
    "dds_qget_durability": _p(_BOOL, _POINTER, _OUT_INT, holds=True),
    "dds_qget_durability_service": _p(
        _BOOL, _POINTER, _OUT_TIME, _OUT_INT, *[ct.POINTER(ct.c_int32)] * 4, holds=True
    ),
    "dds_qget_liveliness": _p(_BOOL, _POINTER, _OUT_INT, _OUT_TIME, holds=True),
    "dds_qget_deadline": _p(_BOOL, _POINTER, _OUT_TIME, holds=True),
    "dds_qget_lifespan": _p(_BOOL, _POINTER, _OUT_TIME, holds=True),
}
PROTOTYPES: Mapping[str, Prototype] = {
    **_ENTITIES,
    **_MATCHES,
    **_SAMPLES_IN_AND_OUT,
    **_POLICIES,
}
"""What both releases have."""

SERTYPE = "dds_get_entity_sertype"
"""Only release 11 has it."""
NEWER: Mapping[str, Prototype] = {
    SERTYPE: _p(RETURN, ENTITY, ct.POINTER(ct.c_void_p), holds=True),
}
