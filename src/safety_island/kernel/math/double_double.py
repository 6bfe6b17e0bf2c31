# SPDX-License-Identifier: Apache-2.0
"""Numbers of about 106 bits: the sum of two doubles, of which the second is the rounding error.

Sums: Knuth, and Dekker where the first operand is the larger one; products: Dekker, with Veltkamp's
split (T. J. Dekker, "A floating-point technique for extending the available precision", 1971).
They are exact while nothing overflows, and no fused multiply-add is made of them.
"""

from safety_island.kernel.kernel import kernel

SPLITTER = 134217729.0
"""2**27 + 1: cuts a double into two halves of 26 bits."""


@kernel
def two_sum(a, b):
    """a + b, and the error of that sum."""
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


@kernel
def fast_two_sum(a, b):
    """a + b, and the error of that sum, for |a| >= |b| or a = 0."""
    total = a + b
    return total, b - (total - a)


@kernel
def two_product(a, b):
    """a * b, and the error of that product, for operands below 2**996."""
    product = a * b
    wide = SPLITTER * a
    a_high = wide - (wide - a)
    a_low = a - a_high
    wide = SPLITTER * b
    b_high = wide - (wide - b)
    b_low = b - b_high
    rest = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low
    return product, rest


@kernel
def short_product(a, b):
    """a * b, and the error of that product, for an ``a`` of at most 26 bits."""
    product = a * b
    wide = SPLITTER * b
    b_high = wide - (wide - b)
    return product, (a * b_high - product) + a * (b - b_high)


@kernel
def multiply(a, a_low, b, b_low):
    """Product of two such numbers."""
    product, rest = two_product(a, b)
    return fast_two_sum(product, rest + (a * b_low + a_low * b))


@kernel
def divide(a, a_low, b, b_low):
    """Quotient of two such numbers: that of the doubles, and what it leaves over.

    A processor divides twice at once when neither division waits for the other one.
    """
    quotient = a / b
    inverse = 1.0 / b
    product, rest = two_product(quotient, b)
    left = ((a - product) - rest) + (a_low - quotient * b_low)
    return quotient, left * inverse
