# SPDX-License-Identifier: Apache-2.0
"""Scalars mean what they mean to ROS 2."""

from __future__ import annotations

import math

import pytest

from safety_island.params.scalars import found, interpret, shown


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("true", True),
        ("True", True),
        ("on", True),
        ("yes", True),
        ("false", False),
        ("OFF", False),
        ("no", False),
        ("~", None),
        ("", None),
        ("0", 0),
        ("-25", -25),
        ("+7", 7),
        ("010", 10),
        ("0.15", 0.15),
        ("-.5", -0.5),
        ("3.", 3.0),
        ("1e-06", 1e-6),
        ("1E3", 1000.0),
        (".inf", math.inf),
        ("-.inf", -math.inf),
        ("mpc", "mpc"),
        ("1:30", "1:30"),
        ("0x10", "0x10"),
        ("1_000", "1_000"),
        ("nan", "nan"),
        ("1.2.3", "1.2.3"),
        ("y", "y"),
    ],
)
def test_plain_scalars(text: str, value: object) -> None:
    result = interpret(text, quoted=False)
    assert result == value
    assert type(result) is type(value)


def test_not_a_number_is_one() -> None:
    result = interpret(".nan", quoted=False)
    assert isinstance(result, float) and math.isnan(result)


@pytest.mark.parametrize("text", ["1", "true", "", ".nan"])
def test_a_quoted_scalar_is_a_text(text: str) -> None:
    assert interpret(text, quoted=True) == text


def test_a_number_with_a_thousand_digits_is_out_of_every_range() -> None:
    assert interpret("9" * 5000, quoted=False) == math.inf


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, "nothing"),
        (True, "true (a switch)"),
        (3, "3 (a whole number)"),
        (0.5, "0.5 (a number)"),
        ("x", "the text 'x'"),
        ([1, 2.0], "[1, 2.0]"),
        ({}, "a map"),
    ],
)
def test_what_was_found_is_told_with_its_type(value: object, text: str) -> None:
    assert found(value) == text


def test_a_long_value_is_told_in_part() -> None:
    assert len(found("x" * 10_000)) < 100
    assert len(found(list(range(10_000)))) < 100


def test_values_are_shown_as_a_file_writes_them() -> None:
    assert [shown(v) for v in (False, 1e-06, (40.0, 50.0), "mpc")] == [
        "false",
        "1e-06",
        "[40.0, 50.0]",
        "mpc",
    ]
