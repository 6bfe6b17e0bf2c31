# SPDX-License-Identifier: Apache-2.0
"""Sums and products of doubles whose error is known exactly."""

from __future__ import annotations

from fractions import Fraction

from hypothesis import given
from hypothesis import strategies as st

from safety_island.kernel.math import double_double

NUMBERS = st.floats(2.0**-200, 2.0**200) | st.floats(-(2.0**200), -(2.0**-200))
SMALL = st.floats(-(2.0**-54), 2.0**-54)


@given(NUMBERS, NUMBERS)
def test_a_sum_and_its_error_are_the_exact_sum(a: float, b: float) -> None:
    total, error = double_double.two_sum(a, b)
    assert total == a + b
    assert Fraction(total) + Fraction(error) == Fraction(a) + Fraction(b)
    high, low = (a, b) if abs(a) >= abs(b) else (b, a)
    assert double_double.fast_two_sum(high, low) == (total, error)


@given(NUMBERS, NUMBERS)
def test_a_product_and_its_error_are_the_exact_product(a: float, b: float) -> None:
    product, error = double_double.two_product(a, b)
    assert product == a * b
    assert Fraction(product) + Fraction(error) == Fraction(a) * Fraction(b)


@given(NUMBERS, SMALL, NUMBERS, SMALL)
def test_long_products_and_quotients_have_a_hundred_bits(
    a: float, a_part: float, b: float, b_part: float
) -> None:
    a_low, b_low = a * a_part, b * b_part
    long_a, long_b = (Fraction(x) + Fraction(low) for x, low in ((a, a_low), (b, b_low)))
    for found, exact in (
        (double_double.multiply(a, a_low, b, b_low), long_a * long_b),
        (double_double.divide(a, a_low, b, b_low), long_a / long_b),
    ):
        error = sum(Fraction(part) for part in found) - exact
        assert abs(error) <= abs(exact) * Fraction(1, 2**100)
