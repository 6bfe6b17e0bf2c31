"""Records of fixed size lie in memory as their CDR lies on the wire."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safety_island.messages import codec, registry
from safety_island.messages.description import Array, Field, Named, Primitive, Struct
from safety_island.messages.errors import IdlError
from safety_island.messages.fixed import cells, record_type
from tests.messages.strategies import messages

FIXED = ("Arm", "InputStatus", "Status")


def fill(target: Any, message: dict[str, Any]) -> None:
    """Write a message through the cells of a record."""
    for name, value in message.items():
        cell = getattr(target, name)
        if isinstance(value, dict):
            fill(cell, value)
        elif isinstance(cell, tuple):
            for inner, item in zip(cell, value, strict=True):
                fill(inner, item)
        else:
            for place, item in enumerate(value if isinstance(value, list) else [value]):
                cell[place] = item


@pytest.mark.parametrize("short", FIXED)
@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_the_bytes_of_a_record_are_the_body_of_the_message(short: str, data: Any) -> None:
    name = f"safety_island_msgs/msg/{short}"
    message = data.draw(messages(name))
    memory = bytearray(record_type(name).itemsize)
    fill(cells(memoryview(memory), record_type(name)), message)
    assert bytes(memory) == codec.encode(name, message)[4:]


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
