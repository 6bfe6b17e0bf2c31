# SPDX-License-Identifier: Apache-2.0
"""fmod, exact for all doubles."""

import math

from safety_island.kernel.kernel import kernel
from safety_island.kernel.math.trigonometric import NAN


@kernel
def fmod(x, y):
    """What division of x by y leaves when the quotient is cut to a whole number; as x signed.

    NaN for an infinite x and for y = 0. Each step doubles or halves a multiple of y or subtracts
    one that is more than half of the rest: all of them exact.
    """
    x, y = float(x), float(y)
    rest, divisor = math.fabs(x), math.fabs(y)
    if not (rest < math.inf and divisor > 0.0):
        return NAN
    if rest < divisor:
        return x
    multiple = divisor
    while multiple <= 0.5 * rest:
        multiple *= 2.0
    while multiple >= divisor:
        if rest >= multiple:
            rest -= multiple
        multiple *= 0.5
    return math.copysign(rest, x)
