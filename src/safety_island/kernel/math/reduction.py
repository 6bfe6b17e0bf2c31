# SPDX-License-Identifier: Apache-2.0
"""An angle less the nearest multiple of pi / 2, for every double.

Below 2**20 the multiple is subtracted in three parts (W. J. Cody and W. Waite, 1980). Beyond, and
where little is left, the angle is multiplied by as many bits of 2 / pi as it needs (M. H. Payne and
R. N. Hanek, 1983), in whole numbers of 26 bits.
"""

import numpy as np

from safety_island.kernel.kernel import kernel
from safety_island.kernel.math.double_double import fast_two_sum, multiply, two_sum

TWO_OVER_PI = 0.6366197723675814
HALF_PI = (1.5707963267948966, 6.123233995736766e-17)
"""Two doubles whose sum is pi / 2."""
HALF_PI_PARTS = (1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21)
"""Three doubles whose sum is pi / 2; the first two have 33 bits: times 20 bits they are exact."""
MEDIUM = 2.0**20
SMALL_REST = 2.0**-20
TO_WHOLE = 1.5 * 2.0**52
"""Added and subtracted, it rounds a number below 2**51 to a whole one."""

LIMB_BITS = 26
LIMB = 2.0**LIMB_BITS
LIMB_MASK = 2**LIMB_BITS - 1
TWO_LIMBS = 2 ** (2 * LIMB_BITS)
HALF_OF_TWO_LIMBS = TWO_LIMBS // 2
_TWO_OVER_PI_DIGITS = int(
    "a2f9836e4e441529fc2757d1f534ddc0db6295993c439041fe5163abdebbc561b7246e3a424dd2e006492eea09d192"
    "1cfe1deb1cb129a73ee88235f52ebb4484e99c7026b45f7e413991d639835339f49c845f8bbdf9283b1ff897ffde05"
    "980fef2f118b5a0a6d1f6d367ecf27cb09b74f463f669e5fea2d7527bac7ebe5f17b3d0739f78a5292ea6bfb5fb11f"
    "8d5d0856033046fc7b6babf0cfbc20",
    16,
)
"""2 / pi times 2**1248."""
_LIMBS = 48
TWO_OVER_PI_LIMBS = np.array(
    [0, 0, 0]
    + [(_TWO_OVER_PI_DIGITS >> (LIMB_BITS * (_LIMBS - 1 - i))) & LIMB_MASK for i in range(_LIMBS)],
    dtype=np.int64,
)
"""Limb i + 2 has the weight 2**(-26 i)."""


@kernel
def reduce_angle(x):
    """Quadrant (0 to 3) and rest, as two doubles, of a finite angle [rad] of at least pi / 4."""
    if x < MEDIUM:
        first, second, third = HALF_PI_PARTS
        turns = (x * TWO_OVER_PI + TO_WHOLE) - TO_WHOLE
        high, low = two_sum(x - turns * first, -turns * second)
        high, low = fast_two_sum(high, low - turns * third)
        if high > SMALL_REST or high < -SMALL_REST:
            return int(turns) & 3, high, low
    return _reduce_with_many_bits(x)


@kernel
def _reduce_with_many_bits(x):
    """As ``reduce_angle``, for any angle of at least 1."""
    shift = 0
    while x >= LIMB:
        x *= 1.0 / LIMB
        shift += 1
    first = int(x)
    rest = (x - first) * LIMB
    second = int(rest)
    third = int((rest - second) * LIMB)

    fourth_part, carry = _two_limbs(shift + 7, first, second, third, 0)
    third_part, carry = _two_limbs(shift + 5, first, second, third, carry)
    second_part, carry = _two_limbs(shift + 3, first, second, third, carry)
    first_part, carry = _two_limbs(shift + 1, first, second, third, carry)
    quadrant = _limb(shift, first, second, third) + carry
    if first_part >= HALF_OF_TWO_LIMBS:  # a half and more: the next quadrant is nearer
        first_part -= TWO_LIMBS
        quadrant += 1

    high, error = two_sum(first_part * 2.0**-52, second_part * 2.0**-104)
    high, low = fast_two_sum(high, third_part * 2.0**-156)
    low = (error + low) + fourth_part * 2.0**-208
    high, low = fast_two_sum(high, low)
    high, low = multiply(high, low, HALF_PI[0], HALF_PI[1])
    return quadrant & 3, high, low


@kernel
def _two_limbs(place, first, second, third, carry):
    """Limbs ``place`` and ``place + 1`` of the product as one whole number, and the carry."""
    lower = _limb(place + 1, first, second, third) + carry
    upper = _limb(place, first, second, third) + (lower >> LIMB_BITS)
    return ((upper & LIMB_MASK) << LIMB_BITS) | (lower & LIMB_MASK), upper >> LIMB_BITS


@kernel
def _limb(place, first, second, third):
    """All products of a limb of the angle and one of 2 / pi that have one weight: below 2**54."""
    return (
        first * int(TWO_OVER_PI_LIMBS[place + 2])
        + second * int(TWO_OVER_PI_LIMBS[place + 1])
        + third * int(TWO_OVER_PI_LIMBS[place])
    )
