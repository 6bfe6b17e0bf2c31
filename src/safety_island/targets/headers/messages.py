# SPDX-License-Identifier: Apache-2.0
"""The message types as a C header, in the mapping that CycloneDDS's own IDL compiler uses.

Struct ``pkg_msg_dds__Name_`` for ``pkg/msg/Name``; a string is ``char *``, or an array when it is
bounded; a sequence is a structure of ``_maximum``, ``_length``, ``_buffer`` and ``_release``.
"""

from __future__ import annotations

from collections.abc import Iterator

from safety_island.dds import topics
from safety_island.dds.names import dds_topic_name
from safety_island.messages import registry
from safety_island.messages.description import (
    Array,
    Element,
    Field,
    Named,
    Primitive,
    Sequence,
    String,
    Struct,
)
from safety_island.targets.errors import BuildError

NAME = "safety_island_messages.h"

_C_TYPES = {
    Primitive.BOOLEAN: "bool",
    Primitive.OCTET: "uint8_t",
    Primitive.FLOAT: "float",
    Primitive.DOUBLE: "double",
}
_TOP = """\
/* SPDX-License-Identifier: Apache-2.0
 *
 * Messages and topics of the safety island, generated from its IDL files.
 */
#ifndef SAFETY_ISLAND_MESSAGES_H
#define SAFETY_ISLAND_MESSAGES_H

#include <stdbool.h>
#include <stdint.h>
"""


def message_header() -> str:
    """Return the header; the same types give the same text."""
    writer = _Writer()
    for name in registry.names():
        writer.add(registry.struct_of(name))
    lines = [_TOP, *writer.lines, *_topics(), "", "#endif"]
    return "\n".join(lines) + "\n"


class _Writer:
    """Writes each struct after those inside it."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self._done: set[str] = set()

    def add(self, struct: Struct) -> None:
        if struct.name in self._done:
            return
        self._done.add(struct.name)
        for inner in registry.inner_structs(struct.name):
            self.add(inner)
        kinds = [item.type for item in struct.fields if isinstance(item.type, Sequence)]
        for kind in kinds:
            self._add_sequence(kind.element)
        self.lines += list(_struct(struct))

    def _add_sequence(self, element: Element) -> None:
        name = _sequence(element)
        if name not in self._done:
            self._done.add(name)
            self.lines += [
                f"typedef struct {name} {{",
                "  uint32_t _maximum;",
                "  uint32_t _length;",
                f"  {_c_type(element)}*_buffer;",
                "  bool _release;",
                f"}} {name};\n",
            ]


def _struct(struct: Struct) -> Iterator[str]:
    known = registry.lookup(struct.name)
    upper = struct.name.replace("/", "_").upper()
    yield f"/* {struct.name} */"
    yield f'#define {upper}_TYPE_NAME "{known.dds_name}"'
    yield f'#define {upper}_TYPE_HASH "{known.hash}"'
    for constant, value in struct.constants.items():
        yield f"#define {upper}_{constant} {value}"
    name = _c_name(struct.name)
    yield f"typedef struct {name} {{"
    for item in struct.fields:
        yield f"  {_member(item)};"
    yield f"}} {name};\n"


def _member(item: Field) -> str:
    if isinstance(item.type, Sequence):
        return f"{_sequence(item.type.element)} {item.name}"
    if isinstance(item.type, String) and item.type.bound is not None:
        return f"char {item.name}[{item.type.bound + 1}]"
    if isinstance(item.type, Array):
        return f"{_c_type(item.type.element)}{item.name}[{item.type.size}]"
    return f"{_c_type(item.type)}{item.name}"


def _c_type(element: Element) -> str:
    """The type and what stands before a name."""
    if isinstance(element, String):
        if element.bound is not None:
            raise BuildError("an array or sequence of bounded strings has no place in the C header")
        return "char *"
    if isinstance(element, Named):
        return f"{_c_name(element.name)} "
    return f"{_C_TYPES.get(element, f'{element.value}_t')} "


def _sequence(element: Element) -> str:
    return f"dds_sequence_{_c_type(element).rstrip(' *')}"


def _c_name(name: str) -> str:
    return registry.dds_type_name(name).replace("::", "_")


def _topics() -> Iterator[str]:
    yield "/* Topics, by their DDS names. */"
    for entry in topics.TOPICS:
        yield f'#define SAFETY_ISLAND_TOPIC_{entry.key.upper()} "{dds_topic_name(entry.name)}"'
