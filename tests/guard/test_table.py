# SPDX-License-Identifier: Apache-2.0
"""Limits by speed, and values within intervals."""

from __future__ import annotations

from dataclasses import fields

import pytest

from safety_island.guard import GuardParams
from safety_island.guard.confine import confine, share, within
from safety_island.guard.table import COLUMNS, SpeedTable
from tests.guard.rig import limited

LISTS = {name: (1.0 + i, 5.0 + 3.0 * i, 4.0 - i) for i, name in enumerate(COLUMNS)}


@pytest.mark.parametrize(
    ("speed", "left", "share_of_next"),
    [(0.0, 0, 0.0), (2.0, 0, 0.0), (3.0, 0, 0.25), (6.0, 1, 0.0), (9.0, 1, 0.75), (99.0, 2, 0.0)],
)
def test_every_list_is_linear_between_its_points(
    speed: float, left: int, share_of_next: float
) -> None:
    table = SpeedTable(limited(speed_points=(2.0, 6.0, 10.0), **LISTS))
    right = min(left + 1, 2)
    expected = [
        (1.0 - share_of_next) * values[left] + share_of_next * values[right]
        for values in LISTS.values()
    ]
    assert table.at(speed) == pytest.approx(expected)


def test_one_point_is_enough() -> None:
    table = SpeedTable(limited(speed_points=(3.0,), **{name: (2.0,) for name in COLUMNS}))
    assert table.at(0.0) == table.at(3.0) == table.at(99.0) == (2.0,) * 10


@pytest.mark.parametrize("wrong", [{"jerk": (1.0, 2.0, 3.0)}, {"speed_points": (0.0, 5.0, 10.0)}])
def test_lists_of_unequal_length_make_no_table(wrong: dict[str, tuple[float, ...]]) -> None:
    with pytest.raises(ValueError, match="zip"):
        SpeedTable(limited(**wrong))


def test_every_list_of_the_parameters_is_a_column() -> None:
    lists = [item.name for item in fields(GuardParams) if str(item.type).startswith("tuple")]
    assert lists == ["speed_points", *COLUMNS]


@pytest.mark.parametrize(
    ("value", "bounds", "expected"),
    [
        (1.0, [(1, 1.0, 2.0), (2, 0.0, 1.0)], (1.0, 0)),
        (3.0, [(1, 1.0, 2.0)], (2.0, 1)),
        (0.0, [(1, 1.0, 2.0)], (1.0, 1)),
        (5.0, [(1, 0.0, 4.0), (2, 0.0, 2.0), (4, 0.0, 3.0)], (2.0, 7)),
        (5.0, [(1, 0.0, 4.0), (2, 4.5, 6.0)], (4.5, 3)),
        (-5.0, [(1, -4.0, 0.0), (2, -6.0, -4.5)], (-4.5, 3)),
        (5.0, [(1, 0.0, 4.0), (2, 5.0, 6.0)], (5.0, 3)),
        (5.0, [(2, 5.0, 9.0), (1, 0.0, 4.0)], (4.0, 1)),
        (5.0, [(2, 0.0, 5.0), (1, 6.0, 9.0)], (6.0, 1)),
    ],
)
def test_confine(value: float, bounds: list[tuple[int, float, float]], expected: object) -> None:
    bits, lows, highs = zip(*bounds, strict=True)
    assert confine(value, (bits, lows, highs)) == expected


@pytest.mark.parametrize(
    ("value", "expected"), [(2.0, (2.0, 0)), (-2.0, (-2.0, 0)), (3.0, (2.0, 8)), (-3.0, (-2.0, 8))]
)
def test_within(value: float, expected: object) -> None:
    assert within(value, 2.0, 8) == expected


@pytest.mark.parametrize(
    ("value", "confined", "start", "expected"),
    [
        (2.0, 1.0, 0.0, 0.5),
        (-2.0, -1.0, 0.0, 0.5),
        (2.0, -1.0, 0.0, 0.0),
        (2.0, 3.0, 0.0, 1.0),
        (2.0, 2.0, 1.0, 1.0),
        (2.0, 1.0, 2.0, 0.0),
        (0.5, 0.25, 0.0, 0.5),
    ],
)
def test_share(value: float, confined: float, start: float, expected: float) -> None:
    assert share(value, confined, start) == expected


def test_the_strictest_of_a_span_are_the_lower_ends() -> None:
    table = SpeedTable(limited(speed_points=(0.0, 10.0), jerk=(3.0, 1.0), acceleration=(1.0, 2.0)))
    drive, rise = COLUMNS.index("acceleration"), COLUMNS.index("jerk")
    for speed, expected in ((-1.0, (1.0, 3.0)), (0.0, (1.0, 1.0)), (10.0, (2.0, 1.0))):
        found = table.strictest(speed)
        assert (found[drive], found[rise]) == expected
        assert found[0] == table.at(speed)[0]
