# SPDX-License-Identifier: Apache-2.0
"""exp and log of every double."""

import math

import numpy as np

from safety_island.kernel.kernel import kernel
from safety_island.kernel.math.double_double import SPLITTER, fast_two_sum, two_sum
from safety_island.kernel.math.reduction import TO_WHOLE
from safety_island.kernel.math.trigonometric import NAN

LN2 = (0.6931471805592082, 7.371002565167799e-13)
"""Two doubles whose sum is ln(2); the first has 40 bits: times a whole number it is exact."""
OVERFLOW, UNDERFLOW = 710.0, -746.0
"""From here on exp is infinite, and nothing."""

EXPONENTIAL = (
    0.5,
    0.1666666666666667,
    0.04166666666666667,
    0.00833333333332612,
    0.0013888888888883737,
    0.00019841269874873975,
    2.480158732558584e-05,
    2.755725533255441e-06,
    2.7557273594799413e-07,
    2.510524515390137e-08,
    2.0914707069612355e-09,
)
"""(exp(x) - 1 - x) / x**2 for |x| <= ln(2) / 2."""
LOGARITHM = (
    0.3333333333333335,
    0.1999999999994962,
    0.14285714313047945,
    0.1111110555757208,
    0.09091445278347801,
    0.0766583701508393,
    0.07308518774395825,
)
"""(atanh(s) / s - 1) / s**2 as a polynomial of s**2."""

INVERSE_LN2 = 1.4426950408889634
FAR = 2.0**64
ROOT_2 = 1.4142135623730951
FINE_POWERS = np.array([2.0**i for i in range(32)])
COARSE_POWERS = np.array([2.0 ** (32 * i - 1024) for i in range(64)])


@kernel
def power_of_two(n):
    """2**n for a whole number from -1022 to 1023."""
    return float(COARSE_POWERS[(n + 1024) >> 5]) * float(FINE_POWERS[n & 31])


@kernel
def exp(x):
    """e to the power of x."""
    x = float(x)
    if not UNDERFLOW < x < OVERFLOW:
        return NAN if math.isnan(x) else (math.inf if x > 0.0 else 0.0)
    twos = (x * INVERSE_LN2 + TO_WHOLE) - TO_WHOLE
    r, r_low = two_sum(x - twos * LN2[0], -twos * LN2[1])
    high, error = fast_two_sum(1.0, r)
    value = high + (error + (r_low + _bend_of_exponential(r)))
    n = int(twos)
    if -1022 <= n <= 1023:
        return value * power_of_two(n)
    return value * power_of_two(n >> 1) * power_of_two(n - (n >> 1))


@kernel
def _bend_of_exponential(r):
    """exp(r) - 1 - r."""
    a, b, c, d, e, f, g, h, i, j, k = EXPONENTIAL
    upper = f + r * (g + r * (h + r * (i + r * (j + r * k))))
    return r * r * (a + r * (b + r * (c + r * (d + r * (e + r * upper)))))


@kernel
def log(x):
    """Natural logarithm; -inf at 0, NaN below."""
    x = float(x)
    if not 0.0 < x < math.inf:
        return -math.inf if x == 0.0 else (x if x == math.inf else NAN)
    mantissa, n = _split(x)
    above = mantissa - 1.0  # exact
    half, half_low = _half_square(above)
    high, error = two_sum(n * LN2[0], above)
    high, more = fast_two_sum(high, -half)
    low = n * LN2[1] - half_low + _curve_of_logarithm(above, half + half_low)
    return high + (more + (error + low))


@kernel
def _half_square(x):
    """x**2 / 2: that of its upper 26 bits, which is exact, and the rest."""
    wide = SPLITTER * x
    top = wide - (wide - x)
    return 0.5 * top * top, 0.5 * (x - top) * (x + top)


@kernel
def _curve_of_logarithm(x, half_square):
    """log(1 + x) - x + x**2 / 2.

    log(1 + x) = 2 atanh(s) = 2 s + s R(s**2) with s = x / (2 + x). As 2 s = x - s x and
    s x = (1 - s) x**2 / 2, only this small part depends on the rounding of s.
    """
    s = x / (2.0 + x)
    a, b, c, d, e, f, g = LOGARITHM
    z = s * s
    rest = 2.0 * z * (a + z * (b + z * (c + z * (d + z * (e + z * (f + z * g))))))
    return s * (half_square + rest)


@kernel
def _split(x):
    """Number in [1 / root 2, root 2], and power of two, whose product is a positive number."""
    n = 0
    while x >= FAR:
        x *= 1.0 / FAR
        n += 64
    while x < 1.0:
        x *= FAR
        n -= 64
    step = 32
    while step > 0:
        if x >= power_of_two(step):
            x *= power_of_two(-step)
            n += step
        step >>= 1
    if x > ROOT_2:
        x *= 0.5
        n += 1
    return x, n
