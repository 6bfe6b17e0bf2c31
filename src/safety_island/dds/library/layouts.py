# SPDX-License-Identifier: Apache-2.0
"""Structures of the C library's public headers; the same in 0.10 and 11, and checked in use."""

from __future__ import annotations

import ctypes as ct

ENTITY = ct.c_int32
"""``dds_entity_t``"""
RETURN = ct.c_int32
"""``dds_return_t``"""
DURATION = ct.c_int64
"""``dds_duration_t`` [ns]"""
HANDLE = ct.c_uint64
"""``dds_instance_handle_t``"""

LIBRARY = 0x7FFF0100
"""``DDS_CYCLONEDDS_HANDLE``: the library as a whole, the parent of all domains."""
PUBLICATIONS, SUBSCRIPTIONS = 0x7FFF0003, 0x7FFF0004
"""``DDS_BUILTIN_TOPIC_DCPSPUBLICATION`` and ``DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION``"""

NOT_READ, ANY_SAMPLE = 2, 1 | 2
ANY_VIEW = 4 | 8
ALIVE, DISPOSED, NO_WRITERS = 16, 32, 64
ANY_INSTANCE = ALIVE | DISPOSED | NO_WRITERS
ANY = ANY_SAMPLE | ANY_VIEW | ANY_INSTANCE
"""Masks of samples, by what the reader and the writers did to them."""

DATA = 2
"""``SDK_DATA``: a sample that is more than its key."""


class Guid(ct.Structure):
    """``dds_guid_t``"""

    _fields_ = (("bytes", ct.c_ubyte * 16),)


class SampleInfo(ct.Structure):
    """``dds_sample_info_t``"""

    _fields_ = (
        ("sample_state", ct.c_int),
        ("view_state", ct.c_int),
        ("instance_state", ct.c_int),
        ("valid_data", ct.c_bool),
        ("source_timestamp", ct.c_int64),
        ("instance_handle", HANDLE),
        ("publication_handle", HANDLE),
        ("disposed_generation_count", ct.c_uint32),
        ("no_writers_generation_count", ct.c_uint32),
        ("sample_rank", ct.c_uint32),
        ("generation_rank", ct.c_uint32),
        ("absolute_generation_rank", ct.c_uint32),
    )


class EndpointData(ct.Structure):
    """``dds_builtintopic_endpoint_t``"""

    _fields_ = (
        ("key", Guid),
        ("participant_key", Guid),
        ("participant_instance_handle", HANDLE),
        ("topic_name", ct.c_char_p),
        ("type_name", ct.c_char_p),
        ("qos", ct.c_void_p),
    )


class Metadata(ct.Structure):
    """``struct dds_type_meta_ser``"""

    _fields_ = (("data", ct.c_void_p), ("size", ct.c_uint32))


class Descriptor(ct.Structure):
    """``dds_topic_descriptor_t``"""

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
        ("type_information", Metadata),
        ("type_mapping", Metadata),
        ("representations", ct.c_uint32),
    )


class Filter(ct.Structure):
    """``struct dds_topic_filter``"""

    _fields_ = (("mode", ct.c_int), ("function", ct.c_void_p), ("argument", ct.c_void_p))


class Vector(ct.Structure):
    """``struct iovec``"""

    _fields_ = (("base", ct.c_char_p), ("length", ct.c_size_t))
