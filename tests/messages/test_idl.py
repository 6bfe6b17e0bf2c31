# SPDX-License-Identifier: Apache-2.0
"""The IDL reader: what it understands, and one line for what it does not."""

from __future__ import annotations

import pytest

from safety_island.messages.description import Array, Named, Primitive, Sequence, String
from safety_island.messages.errors import IdlError
from safety_island.messages.idl import parse_idl

EVERYTHING = """
// as rosidl writes it
#include "std_msgs/msg/Header.idl"
module pkg {
  module msg {
    module Thing_Constants {
      const int32 LOW = -3;
      @verbatim (language="comment", text="up" "down")
      const uint8 HIGH = 7;
    };
    /* several
       lines */
    @verbatim (language="comment", text=
      "a; { string }")
    struct Thing {
      std_msgs::msg::Header header;
      @default (value=TRUE)
      boolean on;
      @unit (value="m")
      double grid[4];
      string<8> short_name;
      sequence<uint8> raw;
      sequence<pkg::msg::Other, 3> others;
      @key
      @default (value="x")
      string text;
      octet one;
      int64 big;
    };
  };
};
"""


def test_everything_that_rosidl_writes() -> None:
    (struct,) = parse_idl(EVERYTHING)
    assert struct.name == "pkg/msg/Thing"
    assert dict(struct.constants) == {"LOW": -3, "HIGH": 7}
    assert {field.name: field.type for field in struct.fields} == {
        "header": Named("std_msgs/msg/Header"),
        "on": Primitive.BOOLEAN,
        "grid": Array(Primitive.DOUBLE, 4),
        "short_name": String(8),
        "raw": Sequence(Primitive.UINT8),
        "others": Sequence(Named("pkg/msg/Other"), 3),
        "text": String(),
        "one": Primitive.OCTET,
        "big": Primitive.INT64,
    }
    defaults = {field.name: field.default for field in struct.fields if field.default is not None}
    assert defaults == {"on": True, "text": "x"}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("module a {", "a.idl:1: the file ends too early"),
        ("struct A { double x; };", "a.idl:1: found 'struct', expected 'module'"),
        ("module a {\n struct A {\n  long x;\n };\n};", "a.idl:3: unknown type 'long'"),
        ("module a {\n struct A {\n  double x\n };\n};", "a.idl:4: found '}', expected ';'"),
        ("module a { ? };", "a.idl:1: unexpected character '?'"),
        (
            "module a { struct A { sequence<sequence<double>> x; }; };",
            "a sequence of sequences is not supported",
        ),
        (
            "module a { struct A { sequence<double> x[2]; }; };",
            "an array of sequences is not supported",
        ),
        ("module a { struct A { double x[n]; }; };", "found 'n', expected a number"),
    ],
)
def test_what_is_not_understood_is_one_line(text: str, said: str) -> None:
    with pytest.raises(IdlError) as refused:
        parse_idl(text, "a.idl")
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)
