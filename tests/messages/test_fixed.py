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
from safety_island.messages.errors import DecodeError, IdlError
from safety_island.messages.fixed import (
    FixedMessage,
    body_size,
    check_flags,
    layout,
    record_type,
)
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


@pytest.fixture
def structs(monkeypatch: pytest.MonkeyPatch) -> dict[str, Struct]:
    """Messages of the test, known beside those of the files."""
    made: dict[str, Struct] = {}
    known = registry.struct_of
    monkeypatch.setattr(
        "safety_island.messages.fixed.struct_of", lambda name: made.get(name) or known(name)
    )
    return made


def add(structs: dict[str, Struct], name: str, *kinds: Any) -> str:
    fields = tuple(Field(f"f{number}", kind) for number, kind in enumerate(kinds))
    structs[name] = Struct(name, fields)
    return name


@pytest.mark.parametrize("kind", [Primitive.DOUBLE, Named("geometry_msgs/msg/Vector3")])
def test_gaps_that_both_have_are_written(structs: dict[str, Struct], kind: Any) -> None:
    name = add(structs, "pkg/msg/Gap", Primitive.UINT8, Array(kind, 2), Primitive.BOOLEAN)
    found = record_type.__wrapped__(name)
    assert found.fields["f1"][1] == 8
    assert struct.calcsize("<" + layout(found)) == body_size(found) == found.itemsize - 7


@pytest.mark.parametrize("follower", [Primitive.UINT8, Primitive.FLOAT])
def test_a_layout_that_c_and_cdr_do_not_share_is_refused(
    structs: dict[str, Struct], follower: Primitive
) -> None:
    inner = add(structs, "pkg/msg/Inner", Primitive.DOUBLE, Primitive.BOOLEAN)
    name = add(structs, "pkg/msg/Outer", Named(inner), follower)
    with pytest.raises(IdlError, match="C and CDR would lay out its fields differently"):
        record_type.__wrapped__(name)


def test_a_message_in_memory_is_the_message() -> None:
    name = "autoware_control_msgs/msg/Control"
    message = FixedMessage(name)
    assert message.to_bytes() == codec.encode(name, {})
    control = message.body[0]
    control.stamp.sec, control.lateral.steering_tire_angle = -2, 0.25
    control.lateral.is_defined_steering_tire_rotation_rate = True
    control.longitudinal.jerk, control.longitudinal.is_defined_jerk = 0.5, True
    lateral = {"steering_tire_angle": 0.25, "is_defined_steering_tire_rotation_rate": True}
    longitudinal = {"jerk": 0.5, "is_defined_jerk": True}
    parts = {"stamp": {"sec": -2}, "lateral": lateral, "longitudinal": longitudinal}
    assert message.to_bytes() == codec.encode(name, parts)
    assert message.body.ctypes.data % 8 == 0


@pytest.mark.parametrize("place", [44, 76, 77])
def test_a_boolean_is_zero_or_one(place: int) -> None:
    name = "autoware_control_msgs/msg/Control"
    data = bytearray(FixedMessage(name).to_bytes())
    for value in (0, 1):
        data[place] = value
        check_flags(bytes(data), record_type(name), name)
    data[place] = 2
    with pytest.raises(DecodeError):
        check_flags(bytes(data), record_type(name), name)


def test_a_message_without_fixed_size_is_refused() -> None:
    with pytest.raises(IdlError, match=r"Header.frame_id: found String, expected fixed size"):
        record_type("std_msgs/msg/Header")
