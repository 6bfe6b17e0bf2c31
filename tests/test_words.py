# SPDX-License-Identifier: Apache-2.0
"""Names as they are told to a person."""

from __future__ import annotations

from enum import Enum

import pytest

from safety_island.words import did_you_mean, in_words, nearest, words_of


class Colour(Enum):
    DARK_GREEN = 1


@pytest.mark.parametrize(
    ("name", "found"),
    [("odometri", "odometry"), ("odometry", "odometry"), ("xyz", None), ("", None)],
)
def test_the_nearest_name(name: str, found: str | None) -> None:
    assert nearest(name, ["trajectory", "odometry"]) == found


def test_the_end_of_an_error() -> None:
    assert did_you_mean("steerin", ["steering", "odometry"]) == "; did you mean 'steering'?"
    assert did_you_mean("xyz", ["steering"]) == ""
    assert did_you_mean("xteer", iter(["steering"]), like=0.9) == ""


def test_an_enumeration_in_words() -> None:
    assert words_of(Colour.DARK_GREEN) == in_words("DARK_GREEN") == "dark green"
