# SPDX-License-Identifier: Apache-2.0
"""Natural cubic splines: both fits, the value between knots and beyond them, unwrapping."""

from __future__ import annotations

import math

import numpy as np
import pytest

from safety_island.control.spline import (
    fit_space_curve,
    interval_from,
    second_derivatives,
    spline_value,
    unwrap_step,
)


def test_hand_made_spline() -> None:
    """Values 0, 1, 0 at 0, 1, 2: the middle second derivative is -3 (4 m = 6 (-1 - 1))."""
    arc, values = np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0, 0.0])
    gain, second = np.array([0.0, 0.25, 0.0]), np.full(3, np.nan)
    second_derivatives(arc, gain, values, second, 3)
    np.testing.assert_array_equal(second, [0.0, -3.0, 0.0])
    assert spline_value(arc, values, second, 0, 0.5) == 0.6875  # 1.5 s - 0.5 s^3
    assert spline_value(arc, values, second, 1, 1.5) == 0.6875
    assert spline_value(arc, values, second, 1, 2.1) == pytest.approx(-0.1495), "not clipped"


@pytest.mark.parametrize("n", [2, 3, 4, 40])
def test_three_curves_at_once_are_the_three_one_by_one(n: int) -> None:
    rng = np.random.default_rng(n)
    x, y, z = np.cumsum(rng.uniform(0.1, 1.0, n)), rng.normal(size=n), rng.normal(size=n)
    arc, gain = np.full(n, np.nan), np.full(n, np.nan)
    together = np.full((3, n), np.nan)
    fit_space_curve(arc, gain, x, y, z, *together, n)
    np.testing.assert_allclose(np.diff(arc), np.hypot(np.diff(x), np.diff(y)), rtol=1e-13)
    for values, second in zip((x, y, z), together, strict=True):
        alone = np.full(n, np.nan)
        second_derivatives(arc, gain, values, alone, n)
        np.testing.assert_allclose(second, alone, rtol=0, atol=1e-11)


@pytest.mark.parametrize(("s", "interval"), [(-1.0, 0), (1.0, 0), (1.1, 1), (3.0, 1), (9.0, 1)])
def test_a_knot_belongs_to_the_interval_before_it(s: float, interval: int) -> None:
    assert interval_from(np.array([0.0, 1.0, 3.0]), 3, 0, s) == interval


@pytest.mark.parametrize("turns", [-2, 0, 3])
def test_unwrapping_takes_the_equal_angle_that_is_nearest(turns: int) -> None:
    previous = 3.0 + turns * 2 * math.pi
    for angle, step in ((-3.0, 2 * math.pi - 6.0), (3.1, 0.1), (0.1, -2.9), (-0.1, -3.1)):
        assert unwrap_step(angle, previous) == pytest.approx(previous + step, abs=1e-12)
