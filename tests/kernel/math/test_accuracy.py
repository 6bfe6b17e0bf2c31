# SPDX-License-Identifier: Apache-2.0
"""Every maths function is less than 1 ulp from the exact value."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import pytest
from mpmath import mp, mpf

from safety_island.kernel.kernel import JIT
from safety_island.kernel.math.inverse import atan2
from safety_island.kernel.math.remainder import fmod
from tests.kernel.math.functions import (
    OF_ONE,
    SPECIAL,
    angle,
    any_double,
    exponent,
    positive,
    share,
    side,
)

COUNT = 3000 if JIT else 1000
BITS = 1400
"""Precision in which the largest angle still has its place in a turn."""
DOMAINS: dict[str, list[Callable[[random.Random], float]]] = {
    "sin": [angle, any_double],
    "cos": [angle, any_double],
    "tan": [angle, any_double],
    "asin": [share],
    "acos": [share],
    "atan": [share, angle, any_double],
    "exp": [exponent],
    "log": [positive],
}
BOUNDS = {"sin": 0.8, "cos": 0.8, "exp": 0.7, "log": 0.75}
"""Largest error [ulp] that the method has; of the others little more than the last rounding."""


def ulps(found: float, exact: Any) -> float:
    """Distance from the exact value, in units of the last place of the double next to it."""
    return float(abs(mpf(found) - exact) / mpf(math.ulp(float(exact))))


def numbers(name: str, count: int) -> list[float]:
    """Arguments in the domain of a function, special ones first."""
    rng = random.Random(f"{name} 1")
    limits = {"asin": 1.0, "acos": 1.0, "exp": 709.78}
    limit = limits.get(name, math.inf)
    special = [x * sign for x in SPECIAL for sign in (1.0, -1.0) if abs(x) < limit]
    found = special + [rng.choice(DOMAINS[name])(rng) for _ in range(count)]
    return [x for x in found if x > 0.0] if name == "log" else found


@pytest.mark.parametrize("name", OF_ONE)
def test_the_error_is_below_an_ulp(
    name: str, record_property: Callable[[str, object], None]
) -> None:
    exactly, worst = getattr(mp, name), (0.0, 0.0)
    for x in numbers(name, COUNT):
        with mp.workprec(BITS if name in ("sin", "cos", "tan") and abs(x) > 1e5 else 200):
            worst = max(worst, (ulps(OF_ONE[name](x), exactly(mpf(x))), x))
    record_property("largest error [ulp]", worst)
    assert worst[0] < BOUNDS.get(name, 0.6), worst


def test_the_error_of_an_angle_of_a_point_is_below_an_ulp() -> None:
    rng, worst = random.Random(2), (0.0, 0.0, 0.0)
    for _ in range(COUNT):
        y, x = side(rng), side(rng)
        if rng.random() < 0.7:  # sides that are comparable, of any size
            x = math.ldexp(math.frexp(x)[0], rng.randrange(-1000, 1000))
            y = math.ldexp(math.frexp(y)[0], math.frexp(x)[1] + rng.randrange(-70, 20))
        with mp.workprec(200):
            worst = max(worst, (ulps(atan2(y, x), mp.atan2(mpf(y), mpf(x))), y, x))
    assert worst[0] < 0.6, worst


def test_the_angle_that_is_nearest_to_a_right_one_keeps_its_digits() -> None:
    """Kahan and McDonald: 62 bits cancel."""
    x = 6381956970095103 * 2.0**797
    with mp.workprec(BITS):
        exact = mp.cos(mpf(x))
        assert abs(exact) < 1e-18
        assert ulps(OF_ONE["cos"](x), exact) < 0.8
        assert ulps(OF_ONE["tan"](x), mp.tan(mpf(x))) < 0.8


def test_a_remainder_is_exact() -> None:
    rng = random.Random(3)
    for _ in range(COUNT):
        x, y = side(rng), side(rng)
        if rng.random() < 0.7:
            y = math.ldexp(math.frexp(y)[0], math.frexp(x)[1] + rng.randrange(-60, 3))
        if y == 0.0:
            continue
        cut = abs(Fraction(x)) % abs(Fraction(y))
        assert Fraction(fmod(x, y)) == (cut if x > 0.0 else -cut), (x, y)
