# SPDX-License-Identifier: Apache-2.0
"""Endpoints with type information as recent rmw_cyclonedds announces it (XTypes, dynamic types).

Run as ``python -m tests.dds.dynamic_types DOMAIN TYPE...``: one reader and one writer for each
type, on ``/types/package/Name``; prints ``TYPE WRITERS READERS``, the numbers of matched peers,
whenever they change, and ends when its standard input closes.
"""

from __future__ import annotations

import ctypes as ct
import select
import sys
from typing import Any

from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.internal import DDS

from safety_island.dds.config import DdsConfig
from safety_island.messages import registry
from safety_island.messages.description import Array, FieldType, Named, Primitive, Sequence, String

_library: Any = DDS._dll_handle
_PRIMITIVES = {
    Primitive.BOOLEAN: 1,
    Primitive.OCTET: 2,
    Primitive.INT16: 3,
    Primitive.INT32: 4,
    Primitive.INT64: 5,
    Primitive.UINT16: 6,
    Primitive.UINT32: 7,
    Primitive.UINT64: 8,
    Primitive.FLOAT: 9,
    Primitive.DOUBLE: 10,
    Primitive.INT8: 12,
    Primitive.UINT8: 13,
}
_STRING, _ARRAY, _SEQUENCE, _STRUCTURE = 16, 21, 22, 24
_DEFINITION, _PRIMITIVE = 1, 2
_NEXT_ID, _AT_END, _FINAL = 0xF000000, 0xFFFFFFFF, 0


class _Type(ct.Structure):
    _fields_ = (("x", ct.c_void_p * 2), ("ret", ct.c_int32))


class _TypeOrKind(ct.Union):
    _fields_ = (("type", _Type), ("primitive", ct.c_int))


class _Spec(ct.Structure):
    _fields_ = (("kind", ct.c_int), ("of", _TypeOrKind))


class _TypeDescriptor(ct.Structure):
    _fields_ = (
        ("kind", ct.c_int),
        ("name", ct.c_char_p),
        ("base_type", _Spec),
        ("discriminator_type", _Spec),
        ("bound_count", ct.c_uint32),
        ("bounds", ct.POINTER(ct.c_uint32)),
        ("element_type", _Spec),
        ("key_element_type", _Spec),
    )


class _MemberDescriptor(ct.Structure):
    _fields_ = (
        ("name", ct.c_char_p),
        ("id", ct.c_uint32),
        ("type", _Spec),
        ("default_value", ct.c_char_p),
        ("index", ct.c_uint32),
        ("label_count", ct.c_uint32),
        ("labels", ct.c_void_p),
        ("default_label", ct.c_bool),
    )


def _function(name: str, result: Any, *arguments: Any) -> Any:
    return ct.CFUNCTYPE(result, *arguments)((name, _library))


_entity, _pointer = ct.c_int32, ct.POINTER(ct.c_void_p)
_create = _function("dds_dynamic_type_create", _Type, _entity, _TypeDescriptor)
_add = _function("dds_dynamic_type_add_member", ct.c_int32, ct.POINTER(_Type), _MemberDescriptor)
_extensibility = _function(
    "dds_dynamic_type_set_extensibility", ct.c_int32, ct.POINTER(_Type), ct.c_int
)
_register = _function("dds_dynamic_type_register", ct.c_int32, ct.POINTER(_Type), _pointer)
_descriptor = _function(
    "dds_create_topic_descriptor",
    ct.c_int32,
    ct.c_int,
    _entity,
    ct.c_void_p,
    ct.c_int64,
    _pointer,
)
_topic = _function(
    "dds_create_topic", _entity, _entity, ct.c_void_p, ct.c_char_p, ct.c_void_p, ct.c_void_p
)
_reader, _writer = (
    _function(f"dds_create_{kind}", _entity, _entity, _entity, ct.c_void_p, ct.c_void_p)
    for kind in ("reader", "writer")
)
_writers_of, _readers_of = (
    _function(f"dds_get_matched_{kind}", ct.c_int32, _entity, ct.c_void_p, ct.c_size_t)
    for kind in ("publications", "subscriptions")
)


class TypeBuilder:
    """Builds types the way rmw_cyclonedds does: final structs, mangled names, plain members."""

    def __init__(self, participant: int) -> None:
        self._participant = participant
        self._kept: list[Any] = []

    def topic(self, name: str, type_name: str) -> int:
        """Return a new topic with full type information."""
        made, information, found = self._struct(type_name), ct.c_void_p(), ct.c_void_p()
        assert _register(made, information) == 0
        assert _descriptor(0, self._participant, information, 0, found) == 0
        topic: int = _topic(self._participant, found, f"rt{name}".encode(), None, None)
        assert topic > 0
        return topic

    def _struct(self, name: str) -> _Type:
        described = _TypeDescriptor(kind=_STRUCTURE, name=registry.dds_type_name(name).encode())
        described.element_type.kind = _DEFINITION
        made: _Type = _create(self._participant, described)
        assert made.ret == 0 and _extensibility(made, _FINAL) == 0
        for field in registry.struct_of(name).fields:
            kind = self._spec(field.type, field.name)
            member = _MemberDescriptor(
                name=field.name.encode(), id=_NEXT_ID, index=_AT_END, type=kind
            )
            assert _add(made, member) == 0, (name, field)
        return made

    def _spec(self, kind: FieldType, name: str) -> _Spec:
        if isinstance(kind, Primitive):
            return _Spec(kind=_PRIMITIVE, of=_TypeOrKind(primitive=_PRIMITIVES[kind]))
        if isinstance(kind, Named):
            return _Spec(kind=_DEFINITION, of=_TypeOrKind(type=self._struct(kind.name)))
        described = _TypeDescriptor(kind=_STRING)
        described.element_type.kind = _DEFINITION
        if isinstance(kind, (Array, Sequence)):
            described.kind = _ARRAY if isinstance(kind, Array) else _SEQUENCE
            described.name = name.encode()
            described.element_type = self._spec(kind.element, name)
        self._bound(described, kind)
        return _Spec(kind=_DEFINITION, of=_TypeOrKind(type=_create(self._participant, described)))

    def _bound(self, described: _TypeDescriptor, kind: Array | Sequence | String) -> None:
        bound = kind.size if isinstance(kind, Array) else kind.bound
        if bound is not None:
            bounds = (ct.c_uint32 * 1)(bound)
            self._kept.append(bounds)
            described.bound_count, described.bounds = 1, bounds


def topic_of(type_name: str) -> str:
    """Return the topic that this program uses for a type."""
    return f"/types/{type_name.replace('/msg/', '/')}"


def main(domain_id: int, type_names: list[str]) -> None:
    """Keep endpoints of these types until standard input closes."""
    _domain = Domain(domain_id, DdsConfig(loopback_only=True).xml(domain_id))
    participant = DomainParticipant(domain_id)
    own: int = participant._ref
    builder = TypeBuilder(own)
    ends = {}
    for name in type_names:
        topic = builder.topic(topic_of(name), name)
        ends[name] = (_reader(own, topic, None, None), _writer(own, topic, None, None))
    before: dict[str, tuple[int, int]] = {}
    while not select.select([sys.stdin], [], [], 0.02)[0]:
        for name, (reader, writer) in ends.items():
            now = (_writers_of(reader, None, 0), _readers_of(writer, None, 0))
            if before.get(name) != now:
                print(name, *now, flush=True)
                before[name] = now


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.argv[2:])
