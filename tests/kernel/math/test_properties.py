# SPDX-License-Identifier: Apache-2.0
"""Special values (C99, Annex F), signs, identities, and order of the maths functions."""

from __future__ import annotations

import math
import random
from collections.abc import Callable

import pytest

from safety_island.kernel.math.exponential import exp, log
from safety_island.kernel.math.inverse import acos, asin, atan, atan2
from safety_island.kernel.math.remainder import fmod
from safety_island.kernel.math.trigonometric import cos, sin, tan
from tests.kernel.math.functions import OF_ONE, any_double, positive, share, side

INF, NAN, PI = math.inf, math.nan, math.pi

VALUES = [
    *((f, zero, zero) for f in (sin, tan, asin, atan) for zero in (0.0, -0.0)),
    *((f, x, NAN) for f in (sin, cos, tan, asin, acos) for x in (INF, -INF)),
    *((f, x, NAN) for f in (asin, acos) for x in (1.0 + 2.0**-52, -2.0, 1e300)),
    *((f, x, x) for f in (sin, tan, asin, atan) for x in (5e-324, -5e-324, 2.0**-30)),
    *((cos, x, 1.0) for x in (0.0, -0.0, 5e-324, 1e-9)),
    *((asin, 1.0, PI / 2), (asin, -1.0, -PI / 2), (acos, 1.0, 0.0), (acos, -1.0, PI)),
    *((acos, 0.0, PI / 2), (acos, -0.0, PI / 2)),
    *((atan, INF, PI / 2), (atan, -INF, -PI / 2), (atan, 1.0, PI / 4), (atan, -1.0, -PI / 4)),
    *((exp, 0.0, 1.0), (exp, -0.0, 1.0), (exp, INF, INF), (exp, -INF, 0.0)),
    *((exp, 709.79, INF), (exp, 1e300, INF), (exp, -745.14, 0.0), (exp, -1e300, 0.0)),
    *((exp, -745.13, 5e-324), (log, 5e-324, -744.4400719213812)),
    *((log, 1.0, 0.0), (log, 0.0, -INF), (log, -0.0, -INF), (log, INF, INF)),
    *((log, x, NAN) for x in (-INF, -1.0, -5e-324)),
    *((f, sign * NAN, NAN) for f in OF_ONE.values() for sign in (1.0, -1.0)),
]

ANGLES = [
    *((y, x, y) for y in (0.0, -0.0) for x in (0.0, 1.0, 5e-324, INF)),
    *((y, x, math.copysign(PI, y)) for y in (0.0, -0.0) for x in (-0.0, -1.0, -5e-324, -INF)),
    *((y, x, math.copysign(PI / 2, y)) for y in (1.0, -1.0, 5e-324) for x in (0.0, -0.0)),
    *((y, INF, math.copysign(0.0, y)) for y in (1.0, -1.0)),
    *((y, -INF, math.copysign(PI, y)) for y in (1.0, -1.0)),
    *((y, x, math.copysign(PI / 2, y)) for y in (INF, -INF) for x in (0.0, 1.0, -1e300)),
    *((INF, INF, PI / 4), (-INF, INF, -PI / 4), (INF, -INF, 3 * PI / 4), (-INF, -INF, -3 * PI / 4)),
    *((y, x, NAN) for y, x in ((NAN, 1.0), (1.0, NAN), (NAN, INF), (-INF, NAN), (-NAN, -NAN))),
    *((5e-324, 5e-324, PI / 4), (1.7e308, 1.7e308, PI / 4), (-1e-310, 1e-310, -PI / 4)),
    *((5e-324, 4.0, 0.0), (1e-320, 1.0, 1e-320), (1.0, 1e300, 1e-300), (5e-324, -1.0, PI)),
]

REMAINDERS = [
    *((x, y, x) for x in (0.0, -0.0, 1.0, -1.0) for y in (INF, -INF, 3.0, -3.0)),
    *((x, y, math.copysign(0.0, x)) for x in (6.0, -6.0) for y in (3.0, -3.0, 5e-324)),
    *((x, y, NAN) for x, y in ((INF, 1.0), (-INF, 1.0), (1.0, 0.0), (0.0, -0.0), (INF, INF))),
    *((NAN, 1.0, NAN), (1.0, NAN, NAN), (-NAN, NAN, NAN)),
    *((1.7976931348623157e308, 5e-324, 0.0), (1e-323, 5e-324, 0.0), (1.5e-323, 1e-323, 5e-324)),
]


def assert_same(found: float, expected: float) -> None:
    """One double, its sign too; a NaN has a positive sign, whatever went in."""
    assert found == expected or (math.isnan(found) and math.isnan(expected))
    sign = 1.0 if math.isnan(expected) else expected
    assert math.copysign(1.0, found) == math.copysign(1.0, sign)


@pytest.mark.parametrize(("function", "x", "expected"), VALUES)
def test_a_special_value(function: Callable[[float], float], x: float, expected: float) -> None:
    assert_same(function(x), expected)


@pytest.mark.parametrize(("y", "x", "expected"), ANGLES)
def test_the_angle_of_a_special_point(y: float, x: float, expected: float) -> None:
    assert_same(atan2(y, x), expected)


@pytest.mark.parametrize(("x", "y", "expected"), REMAINDERS)
def test_a_special_remainder(x: float, y: float, expected: float) -> None:
    assert_same(fmod(x, y), expected)


def test_both_signs_are_rounded_alike() -> None:
    rng = random.Random(4)
    for _ in range(2000):
        x, y, part = any_double(rng), side(rng), share(rng)
        for odd in (sin, tan, atan):
            assert_same(odd(-x), -odd(x))
        assert_same(asin(-part), -asin(part))
        assert_same(cos(-x), cos(x))
        assert_same(atan2(-y, x), -atan2(y, x))
        if y != 0.0:
            assert_same(fmod(-x, y), -fmod(x, y))
            assert_same(fmod(x, -y), fmod(x, y))


RISING: dict[str, tuple[Callable[[float], float], float, float]] = {
    "sin": (sin, -PI / 2, PI / 2),
    "minus cos": (lambda x: -cos(x), 0.0, PI),
    "tan": (tan, -PI / 2, PI / 2),
    "asin": (asin, -1.0, 1.0),
    "minus acos": (lambda x: -acos(x), -1.0, 1.0),
    "atan": (atan, -3.0, 3.0),
    "atan2 over a circle": (lambda x: atan2(x, -1.0 if abs(x) < 0.5 else 0.7), 0.5, 4.0),
    "exp": (exp, -745.0, 709.0),
    "log": (log, 0.01, 20.0),
}


@pytest.mark.parametrize("name", RISING)
def test_of_two_neighbours_the_larger_argument_has_no_smaller_value(name: str) -> None:
    function, low, high = RISING[name]
    rng = random.Random(f"{name} 5")
    for _ in range(3000):
        x = low + (high - low) * rng.choice([rng.random(), rng.randrange(1, 256) / 256.0])
        below, above = math.nextafter(x, low), math.nextafter(x, high)
        assert function(below) <= function(x) <= function(above), x


def test_no_value_leaves_its_range() -> None:
    rng = random.Random(6)
    for _ in range(3000):
        x, y, part = any_double(rng), any_double(rng), share(rng)
        assert abs(sin(x)) <= 1.0 and abs(cos(x)) <= 1.0
        assert abs(asin(part)) <= PI / 2 and 0.0 <= acos(part) <= PI
        assert abs(atan(x)) <= PI / 2 and abs(atan2(y, x)) <= PI
        assert abs(fmod(x, y)) < abs(y)


def test_identities_hold_to_a_few_ulps() -> None:
    rng = random.Random(7)
    for _ in range(3000):
        x, part, number = any_double(rng), share(rng), positive(rng)
        assert math.isclose(sin(x) ** 2 + cos(x) ** 2, 1.0, rel_tol=4e-16)
        assert math.isclose(tan(x), sin(x) / cos(x), rel_tol=8e-16)
        assert math.isclose(asin(part) + acos(part), PI / 2, rel_tol=4e-16)
        assert math.isclose(sin(asin(part)), part, rel_tol=8e-16)
        assert math.isclose(exp(log(number)), number, rel_tol=2e-16 * (3.0 + abs(log(number))))
        assert math.isclose(atan2(part, 1.0), atan(part), rel_tol=3e-16)
