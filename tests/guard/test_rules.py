# SPDX-License-Identifier: Apache-2.0
"""Limits by speed, and values within intervals."""

from __future__ import annotations

from math import tan
from typing import Any

import pytest

from safety_island.core.guard import Guard, Proposal, pack_guard
from safety_island.guard import guard
from safety_island.guard.records import LISTS, MAX_SPEED_POINTS
from tests.guard.rig import TIMEOUT, WHEEL_BASE, limited

rules: Any = guard  # without types
VALUES = {name: (1.0 + i, 5.0 + 3.0 * i, 4.0 - i) for i, name in enumerate(LISTS[1:])}


def limits(**changed: Any) -> Any:
    return pack_guard(limited(**changed), WHEEL_BASE, TIMEOUT)[0]


@pytest.mark.parametrize(
    ("speed", "left", "share_of_next"),
    [(0.0, 0, 0.0), (2.0, 0, 0.0), (3.0, 0, 0.25), (6.0, 1, 0.0), (9.0, 1, 0.75), (99.0, 2, 0.0)],
)
@pytest.mark.parametrize("name", VALUES)
def test_every_list_is_linear_between_its_points(
    name: str, speed: float, left: int, share_of_next: float
) -> None:
    packed = limits(speed_points=(2.0, 6.0, 10.0), **VALUES)
    values, right = VALUES[name], min(left + 1, 2)
    expected = (1.0 - share_of_next) * values[left] + share_of_next * values[right]
    assert rules.by_speed(packed, packed[name], speed) == pytest.approx(expected)


def test_one_point_is_enough() -> None:
    packed = limits(speed_points=(3.0,), **{name: (2.0,) for name in VALUES})
    assert [rules.by_speed(packed, packed.jerk, speed) for speed in (0.0, 3.0, 99.0)] == [2.0] * 3


def test_the_longest_list_that_a_record_holds() -> None:
    points = tuple(map(float, range(MAX_SPEED_POINTS)))
    packed = limits(speed_points=points, **dict.fromkeys(VALUES, points))
    assert rules.by_speed(packed, packed.jerk, 30.5) == 30.5
    assert rules.by_speed(packed, packed.jerk, 31.0) == 31.0
    assert rules.by_speed(packed, packed.jerk, 99.0) == 31.0


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
        (2.0, [(8, -2.0, 2.0)], (2.0, 0)),
        (-2.0, [(8, -2.0, 2.0)], (-2.0, 0)),
        (-3.0, [(8, -2.0, 2.0)], (-2.0, 8)),
    ],
)
def test_hold(value: float, bounds: list[tuple[int, float, float]], expected: object) -> None:
    kept, bits = value, 0
    for bit, low, high in bounds:
        kept, bits = rules.hold(value, kept, bits, low, high, bit)
    assert (kept, bits) == expected


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
    assert rules.share(value, confined, start) == expected


def test_what_is_remembered_of_a_command() -> None:
    tested = Guard(limited(), WHEEL_BASE, TIMEOUT)
    assert tested.state.tobytes() == bytes(tested.state.nbytes)
    tested.check(Proposal(10.0, 10.0, 7, 0.0625, 0.0, 0.0, 0.125), 1.0, 0.05)
    memory = tested.state[0]
    assert (memory.is_numbered, memory.sequence) == (True, 7)
    assert memory.sent.tolist() == (True, 10.0, 0.0625, tan(0.0625), 0.125)
    assert not memory.before.exists
    tested.check(Proposal(10.1, 10.1, 8, 0.0, 0.0, 0.0, 0.0), 1.0, 0.05)
    assert memory.before.tolist() == (True, 10.0, 0.0625, tan(0.0625), 0.125)
    assert memory.sent.tolist() == (True, 10.1, 0.0, 0.0, 0.0)
