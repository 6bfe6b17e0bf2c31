# SPDX-License-Identifier: Apache-2.0
"""Every number of ``safety_island.kernel.math`` anew from mathematics, in 60 digits.

``python -m tests.kernel.math.constants`` prints them as they are written in the sources.
Polynomials are near minimax: the interpolation at Chebyshev's points, each coefficient rounded.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from mpmath import mp, mpf

DIGITS = 60


def two_over_pi() -> int:
    """2 / pi as an integer: 48 limbs of 26 bits behind the point."""
    with mp.workprec(1400):
        return int(mp.floor(mp.ldexp(2 / mp.pi, 48 * 26)))


def pair(value: Any) -> tuple[float, float]:
    """The two doubles whose sum is nearest to a value."""
    high = float(value)
    return high, float(value - mpf(high))


def cut(value: Any, bits: int) -> float:
    """A value without what is below 2**-bits."""
    return float(mp.ldexp(mp.floor(mp.ldexp(value, bits)), -bits))


def pi_half_parts() -> tuple[float, float, float]:
    """pi / 2 in three parts; a product of one of the first two with 20 bits is exact."""
    first = cut(mp.pi / 2, 32)
    second = cut(mp.pi / 2 - mpf(first), 65)
    return first, second, float(mp.pi / 2 - mpf(first) - mpf(second))


def ln2_parts() -> tuple[float, float]:
    """ln(2) in two parts; a product of the first with 12 bits is exact."""
    first = cut(mp.ln2, 40)
    return first, float(mp.ln2 - mpf(first))


def polynomial(function: Callable[[Any], Any], low: float, high: float, n: int) -> list[float]:
    """Coefficients, the constant one first, of a function on an interval."""
    return [float(c) for c in mp.chebyfit(function, [mpf(low), mpf(high)], n, asc=True)]


def series(function: Callable[[Any], Any], limit: Callable[[], Any]) -> Callable[[Any], Any]:
    """A function of z that has a hole at 0 filled: there it is its limit."""
    return lambda z: function(mpf(z)) if abs(z) > mpf(10) ** -25 else limit()


def _sine(z: Any) -> Any:
    x = mp.sqrt(z)
    return (mp.sin(x) / x - 1) / z


def _cosine(z: Any) -> Any:
    return ((mp.cos(mp.sqrt(z)) - 1) / z + mpf(1) / 2) / z


def _arc_tangent(z: Any) -> Any:
    x = mp.sqrt(z)
    return (mp.atan(x) / x - 1) / z


def _exponential(x: Any) -> Any:
    return (mp.expm1(x) - x) / x**2


def _logarithm(z: Any) -> Any:
    x = mp.sqrt(z)
    return (mp.atanh(x) / x - 1) / z


def polynomials() -> dict[str, list[float]]:
    """Every polynomial by its name in the sources."""
    third, sixth = mpf(1) / 3, mpf(1) / 6
    sine = series(_sine, lambda: -sixth)
    finer = series(lambda z: (_sine(z) + sixth) / z, lambda: mpf(1) / 120)
    cosine = series(_cosine, lambda: mpf(1) / 24)
    quarter = 0.62  # a bit more than (pi / 4) ** 2
    return {
        "SINE": polynomial(sine, 0.0, quarter, 7),
        "FINER_SINE": polynomial(finer, 0.0, quarter, 6),
        "COSINE": polynomial(cosine, 0.0, quarter, 6),
        "ARC_TANGENT": polynomial(series(_arc_tangent, lambda: -third), 0.0, 0.00102, 4),
        "EXPONENTIAL": polynomial(series(_exponential, lambda: mpf(1) / 2), -0.3467, 0.3467, 11),
        "LOGARITHM": polynomial(series(_logarithm, lambda: third), 0.0, 0.02945, 7),
    }


def values() -> dict[str, float | tuple[float, ...] | list[float]]:
    """Every constant and polynomial by its name in the sources."""
    with mp.workdps(DIGITS):
        return {
            "PI": pair(mp.pi),
            "HALF_PI": pair(mp.pi / 2),
            "HALF_PI_PARTS": pi_half_parts(),
            "LN2": ln2_parts(),
            "SIXTH": pair(mpf(1) / 6),
            "ARC_TANGENTS_HIGH": [pair(mp.atan(mpf(i) / 16))[0] for i in range(17)],
            "ARC_TANGENTS_LOW": [pair(mp.atan(mpf(i) / 16))[1] for i in range(17)],
            **polynomials(),
        }


if __name__ == "__main__":
    print(f"2 / pi: {two_over_pi():x}")
    for name, value in values().items():
        print(name, value)
