# SPDX-License-Identifier: Apache-2.0
"""Type hashes against rosbags, which computes them from its own definitions."""

from __future__ import annotations

import pytest
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from safety_island.messages import registry
from safety_island.messages.idl import parse_idl
from safety_island.messages.type_hash import type_hash
from tests.messages.oracle import typestore


@pytest.mark.parametrize("name", registry.names())
def test_hash_equals_that_of_an_independent_implementation(name: str) -> None:
    assert registry.lookup(name).hash == typestore().hash_rihs01(name)


def test_known_hash_of_ros_2_kilted() -> None:
    """Read from rclpy of ROS 2 Kilted."""
    expected = "RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"
    assert registry.lookup("nav_msgs/msg/Odometry").hash == expected


def test_every_kind_of_field() -> None:
    idl = """module p { module msg { struct T {
        sequence<uint8, 3> a; string<4> b; sequence<string<5>, 2> c; int8 d[2]; octet e;
        sequence<builtin_interfaces::msg::Time> f; uint64 g[1]; float h; int16 i; };};};"""
    msg = """uint8[<=3] a\nstring<=4 b\nstring<=5[<=2] c\nint8[2] d\nbyte e
        builtin_interfaces/Time[] f\nuint64[1] g\nfloat32 h\nint16 i"""
    lines = "\n".join(line.strip() for line in msg.splitlines())
    store = get_typestore(Stores.ROS2_KILTED)
    store.register(get_types_from_msg(lines, "p/msg/T"))
    (struct,) = parse_idl(idl)
    assert type_hash(struct, registry.struct_of) == store.hash_rihs01("p/msg/T")
