# SPDX-License-Identifier: Apache-2.0
"""Records of fixed size lie in memory as their CDR lies on the wire."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safety_island.messages import codec, registry
from safety_island.messages.description import Array, Field, Named, Primitive, Struct
from safety_island.messages.errors import IdlError
from safety_island.messages.fixed import layout, record_type
from tests.messages.strategies import messages

FIXED = ("Arm", "InputStatus", "Status")


def values_of(kind: Any, message: dict[str, Any]) -> Iterator[Any]:
    """Give the values of a message as its layout takes them."""
    for name in kind.names:
        column, value = kind.fields[name][0], message[name]
        if isinstance(value, dict):
            yield from values_of(column, value)
        elif isinstance(value, list) and column.base.names:
            for item in value:
                yield from values_of(column.base, item)
        else:
            yield np.array(value, column.base).tobytes() if column.subdtype else value


@pytest.mark.parametrize("short", FIXED)
@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_the_bytes_of_a_layout_are_the_body_of_the_message(short: str, data: Any) -> None:
    name = f"safety_island_msgs/msg/{short}"
    message, kind = data.draw(messages(name)), record_type(name)
    body = struct.pack("<" + layout(kind), *values_of(kind, message))
    assert body == codec.encode(name, message)[4:]
    assert len(body) == kind.itemsize


@pytest.mark.parametrize("short", FIXED)
def test_the_record_is_the_c_struct(short: str) -> None:
    kind = record_type(f"safety_island_msgs/msg/{short}")
    aligned = np.dtype(kind.descr, align=True)
    assert [aligned.fields[n][1] for n in kind.names] == [kind.fields[n][1] for n in kind.names]
    assert aligned.itemsize == kind.itemsize


@pytest.mark.parametrize("kind", [Primitive.DOUBLE, Named("geometry_msgs/msg/Vector3")])
def test_fields_that_would_need_padding_are_refused(
    kind: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    fields = (Field("small", Primitive.UINT8), Field("large", Array(kind, 2)))
    structs = {"pkg/msg/Padded": Struct("pkg/msg/Padded", fields)}
    known = registry.struct_of
    monkeypatch.setattr(
        "safety_island.messages.fixed.struct_of", lambda name: structs.get(name) or known(name)
    )
    with pytest.raises(IdlError, match="not in an order without padding"):
        record_type.__wrapped__("pkg/msg/Padded")


def test_a_message_without_fixed_size_is_refused() -> None:
    with pytest.raises(IdlError, match=r"Header.frame_id: found String, expected fixed size"):
        record_type("std_msgs/msg/Header")
