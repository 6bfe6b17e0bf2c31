# SPDX-License-Identifier: Apache-2.0
"""atan, atan2, asin and acos, all from the angle of a point in the first octant.

With c the sixteenth that is nearest to y / x: atan(y / x) = atan(c) + atan(u),
u = (y - c x) / (x + c y), |u| <= 1/32. The quotient and the sum are kept in two doubles each.
"""

import math

import numpy as np

from safety_island.kernel.kernel import kernel
from safety_island.kernel.math.double_double import (
    divide,
    fast_two_sum,
    short_product,
    two_product,
    two_sum,
)
from safety_island.kernel.math.reduction import HALF_PI
from safety_island.kernel.math.trigonometric import NAN, TINY

PI = (3.141592653589793, 1.2246467991473532e-16)
"""Two doubles whose sum is pi."""
THREE_QUARTERS_PI = 2.356194490192345

ARC_TANGENT = (-0.3333333333333326, 0.19999999997592258, -0.14285702481332843, 0.11092587642056967)
"""(atan(u) / u - 1) / u**2 as a polynomial of u**2."""
STEPS = 16
FIRST_STEP = 1.0 / 32.0
"""Below, a tangent is nearest to the step 0."""
ARC_TANGENTS_HIGH = np.array(
    [
        0.0,
        0.06241880999595735,
        0.12435499454676144,
        0.18534794999569476,
        0.24497866312686414,
        0.3028848683749714,
        0.35877067027057225,
        0.4124104415973873,
        0.4636476090008061,
        0.5123894603107377,
        0.5585993153435624,
        0.6022873461349642,
        0.6435011087932844,
        0.6823165548747481,
        0.7188299996216245,
        0.7531512809621944,
        0.7853981633974483,
    ]
)
ARC_TANGENTS_LOW = np.array(
    [
        0.0,
        -1.5490756308295046e-18,
        -3.1253241424539383e-18,
        4.180692268843079e-18,
        1.0698755618734451e-17,
        -1.1010827903001369e-17,
        -2.4623815582638635e-17,
        -1.587652227770689e-17,
        2.2698777452961687e-17,
        -2.5462781472855804e-17,
        -5.4556305485916264e-18,
        2.950430737228402e-17,
        1.5834785051444286e-17,
        6.943223671560008e-18,
        -2.1478388444456983e-17,
        -2.4256934659182068e-17,
        3.061616997868383e-17,
    ]
)
"""atan(i / 16) is the sum of the two entries."""

NEGLIGIBLE = 2.0**-60
"""A side of this part of the other one changes a right or straight angle by less than its ulp."""
LARGE, SMALL, SCALE = 2.0**500, 2.0**-400, 2.0**600
"""Beyond these bounds sides are scaled, for products to neither overflow nor vanish."""


@kernel
def atan(x):
    """Angle [rad] in [-pi / 2, pi / 2] whose tangent is x."""
    x = float(x)
    size = math.fabs(x)
    if size < TINY:
        return x
    if size < FIRST_STEP:
        return x + _bend(x)
    if size <= 1.0:
        high, low = _octant(size, 0.0, 1.0, 0.0)
    elif size <= 1.0 / NEGLIGIBLE:
        high, low = _less_than(HALF_PI, _octant(1.0, 0.0, size, 0.0))
    elif size > 0.0:
        high, low = HALF_PI
    else:
        return NAN
    return math.copysign(high + low, x)


@kernel
def atan2(y, x):
    """Angle [rad] in [-pi, pi] of the point (x, y)."""
    y, x = float(y), float(x)
    width, height = math.fabs(x), math.fabs(y)
    if not (width < math.inf and height < math.inf):
        return _angle_of_infinite(y, x)
    is_behind = math.copysign(1.0, x) < 0.0
    if height <= width * NEGLIGIBLE:
        if is_behind:
            return math.copysign(PI[0], y)
        return y / x if y != 0.0 else y
    if width <= height * NEGLIGIBLE:
        return math.copysign(HALF_PI[0], y)
    return math.copysign(_angle(height, width, is_behind), y)


@kernel
def asin(x):
    """Angle [rad] in [-pi / 2, pi / 2] whose sine is x; NaN beyond [-1, 1]."""
    x = float(x)
    size = math.fabs(x)
    if size < TINY:
        return x
    if size < 1.0:
        root, root_low = _other_leg(size)
        if size <= root:
            high, low = _octant(size, 0.0, root, root_low)
        else:
            high, low = _less_than(HALF_PI, _octant(root, root_low, size, 0.0))
        return math.copysign(high + low, x)
    return math.copysign(HALF_PI[0], x) if size == 1.0 else NAN


@kernel
def acos(x):
    """Angle [rad] in [0, pi] whose cosine is x; NaN beyond [-1, 1]."""
    x = float(x)
    size = math.fabs(x)
    if size < 1.0:
        root, root_low = _other_leg(size)
        if size <= root:
            high, low = _less_than(HALF_PI, _octant(size, 0.0, root, root_low))
        else:
            high, low = _octant(root, root_low, size, 0.0)
        if x < 0.0:
            high, low = _less_than(PI, (high, low))
        return high + low
    if size == 1.0:
        return 0.0 if x > 0.0 else PI[0]
    return NAN


@kernel
def _angle_of_infinite(y, x):
    """Angle of a point of which a coordinate is infinite, NaN of one with NaN."""
    if math.isnan(x) or math.isnan(y):
        return NAN
    if math.isinf(x) and math.isinf(y):
        return math.copysign(THREE_QUARTERS_PI if x < 0.0 else ARC_TANGENTS_HIGH[STEPS], y)
    if math.isinf(y):
        return math.copysign(HALF_PI[0], y)
    return math.copysign(PI[0] if x < 0.0 else 0.0, y)


@kernel
def _angle(height, width, is_behind):
    """Angle of a point above the axis, neither side of which is negligible."""
    if height > LARGE or width > LARGE:
        height, width = height / SCALE, width / SCALE
    elif height < SMALL or width < SMALL:
        height, width = height * SCALE, width * SCALE
    if height <= width:
        angle = _octant(height, 0.0, width, 0.0)
    else:
        angle = _less_than(HALF_PI, _octant(width, 0.0, height, 0.0))
    if is_behind:
        angle = _less_than(PI, angle)
    return angle[0] + angle[1]


@kernel
def _octant(y, y_low, x, x_low):
    """Angle of a point with 0 <= y <= x in two doubles; each coordinate is two doubles."""
    step = int(STEPS * y / x + 0.5)
    c = step / STEPS
    product, rest = short_product(c, x)
    up, up_low = two_sum(y, -product)
    up_low += y_low - (rest + c * x_low)
    product, rest = short_product(c, y)
    along, along_low = fast_two_sum(x, product)
    along_low += x_low + (rest + c * y_low)
    u, u_low = divide(up, up_low, along, along_low)
    high, error = fast_two_sum(float(ARC_TANGENTS_HIGH[step]), u)
    return high, error + (float(ARC_TANGENTS_LOW[step]) + (u_low + _bend(u)))


@kernel
def _bend(u):
    """atan(u) - u for |u| <= 1/32."""
    first, second, third, fourth = ARC_TANGENT
    z = u * u
    return u * z * (first + z * (second + z * (third + z * fourth)))


@kernel
def _less_than(whole, angle):
    """A whole angle less another one."""
    high, error = fast_two_sum(whole[0], -angle[0])
    return high, error + (whole[1] - angle[1])


@kernel
def _other_leg(x):
    """Root of 1 - x**2 in two doubles, for 0 <= x < 1."""
    square, rest = two_product(x, x)
    value, low = fast_two_sum(1.0, -square)
    value, low = fast_two_sum(value, low - rest)
    root = math.sqrt(value)
    product, rest = two_product(root, root)
    return root, (((value - product) - rest) + low) / (2.0 * root)
