# SPDX-License-Identifier: Apache-2.0
"""sin, cos and tan of every double.

With z = x**2 and |x| <= pi / 4: sin x = x + x z S(z), cos x = 1 - z / 2 + z**2 C(z). The
polynomials are near minimax (``tests/kernel/math/constants.py`` computes them); the largest terms
are added last, so that their rounding is nearly all of the error.
"""

import math

from safety_island.kernel.kernel import kernel
from safety_island.kernel.math.double_double import divide, fast_two_sum, multiply, two_product
from safety_island.kernel.math.reduction import reduce_angle

NAN = math.nan
EIGHTH = 0.7853981633974483
"""An eighth of a turn, pi / 4."""
TINY = 2.0**-27
"""Below, sin x, tan x and their inverses are x."""

SINE = (
    -0.16666666666666666,
    0.008333333333333331,
    -0.0001984126984126494,
    2.7557319219243677e-06,
    -2.505210619936182e-08,
    1.6058526388142101e-10,
    -7.586389554705215e-13,
)
COSINE = (
    0.041666666666666664,
    -0.0013888888888887359,
    2.48015872987077e-05,
    -2.755731724172776e-07,
    2.0876140031390975e-09,
    -1.138218421447753e-11,
)
SIXTH = (0.16666666666666666, 9.25185853854297e-18)
FINER_SINE = (
    0.008333333333333333,
    -0.00019841269841268941,
    2.7557319222290954e-06,
    -2.5052107218719517e-08,
    1.6058680729167312e-10,
    -7.59504798171654e-13,
)
"""S(z) is -1/6 + z times this."""


@kernel
def sin(x):
    """Sine of an angle [rad]; NaN for what is not finite."""
    x = float(x)
    size = math.fabs(x)
    if size <= EIGHTH:
        return x if size < TINY else _sine(x, 0.0)
    if not size < math.inf:
        return NAN
    quadrant, high, low = reduce_angle(size)
    value = _cosine(high, low) if quadrant & 1 else _sine(high, low)
    return -value if (quadrant >= 2) != (x < 0.0) else value


@kernel
def cos(x):
    """Cosine of an angle [rad]; NaN for what is not finite."""
    size = math.fabs(float(x))
    if size <= EIGHTH:
        return _cosine(size, 0.0)
    if not size < math.inf:
        return NAN
    quadrant, high, low = reduce_angle(size)
    value = _sine(high, low) if quadrant & 1 else _cosine(high, low)
    return -value if quadrant == 1 or quadrant == 2 else value


@kernel
def tan(x):
    """Tangent of an angle [rad]; NaN for what is not finite."""
    x = float(x)
    size = math.fabs(x)
    if size < TINY:
        return x
    if not size < math.inf:
        return NAN
    quadrant, high, low = 0, size, 0.0
    if size > EIGHTH:
        quadrant, high, low = reduce_angle(size)
    value = _tangent(high, low, quadrant & 1)
    return -value if x < 0.0 else value


@kernel
def _sine(x, low):
    """Sine of x + low, both small."""
    a, b, c, d, e, f, g = SINE
    z = x * x
    polynomial = a + z * (b + z * (c + z * (d + z * (e + z * (f + z * g)))))
    return x + (x * z * polynomial + low * (1.0 - 0.5 * z))


@kernel
def _cosine(x, low):
    """Cosine of x + low, both small."""
    a, b, c, d, e, f = COSINE
    z = x * x
    polynomial = a + z * (b + z * (c + z * (d + z * (e + z * f))))
    high, error = fast_two_sum(1.0, -0.5 * z)
    return high + (error + (z * z * polynomial - x * low))


@kernel
def _tangent(x, low, is_odd):
    """Tangent of x + low, both small; ``is_odd``: of a quadrant more, which is -1 / tangent."""
    z, z_low = two_product(x, x)
    z_low += 2.0 * x * low
    sine, sine_low = _finer_sine(x, low, z, z_low)
    cosine, cosine_low = _finer_cosine(z, z_low)
    if is_odd:
        high, rest = divide(cosine, cosine_low, sine, sine_low)
        return -(high + rest)
    high, rest = divide(sine, sine_low, cosine, cosine_low)
    return high + rest


@kernel
def _finer_sine(x, low, z, z_low):
    """Sine of x + low in two doubles, with z = x**2."""
    a, b, c, d, e, f = FINER_SINE
    polynomial = z * (a + z * (b + z * (c + z * (d + z * (e + z * f)))))
    high, rest = fast_two_sum(-SIXTH[0], polynomial)
    high, rest = multiply(high, rest - SIXTH[1], z, z_low)
    high, rest = multiply(high, rest, x, low)
    high, error = fast_two_sum(x, high)
    return high, error + (rest + low)


@kernel
def _finer_cosine(z, z_low):
    """Cosine of the root of z in two doubles."""
    a, b, c, d, e, f = COSINE
    polynomial = z * (a + z * (b + z * (c + z * (d + z * (e + z * f)))))
    high, rest = fast_two_sum(-0.5, polynomial)
    high, rest = multiply(high, rest, z, z_low)
    high, error = fast_two_sum(1.0, high)
    return high, error + rest
