# SPDX-License-Identifier: Apache-2.0
"""Our maths functions as one kernel over records, and arguments that are hard for them.

``python -m tests.kernel.math.functions`` prints a hash of every bit that they return, for a process
that runs them in another way; ``... ir`` prints the LLVM IR that a library is made from.
"""

from __future__ import annotations

import hashlib
import math
import random
import struct
import sys
from collections.abc import Callable
from typing import Any

import numpy as np

from safety_island.kernel.kernel import Entry, kernel
from safety_island.kernel.math.exponential import exp, log
from safety_island.kernel.math.inverse import acos, asin, atan, atan2
from safety_island.kernel.math.remainder import fmod
from safety_island.kernel.math.trigonometric import cos, sin, tan
from safety_island.kernel.records import Records, record

OF_ONE: dict[str, Callable[[float], float]] = {
    "sin": sin,
    "cos": cos,
    "tan": tan,
    "asin": asin,
    "acos": acos,
    "atan": atan,
    "exp": exp,
    "log": log,
}
OF_TWO: dict[str, Callable[[float, float], float]] = {"atan2": atan2, "fmod": fmod}
NAMES = (*OF_ONE, *OF_TWO)
CALL = record([(name, "f8") for name in ("x", "y", *NAMES)])
"""Arguments and values."""
SEED, COUNT = 20260713, 4000
SPECIAL = [
    *(0.0, 5e-324, 2.2250738585072014e-308, 1e-300, 2.0**-60, 2.0**-28, 2.0**-27, 1e-5, 0.03125),
    *(0.5, 0.7853981633974483, 0.7853981633974484, 1.0 - 2.0**-53, 1.0, 1.0 + 2.0**-52),
    *(1.4142135623730951, math.pi / 2, 2.0, 3.0, math.pi, 4.5, 2 * math.pi, 11.0, 708.4, 709.78),
    *(709.79, 745.13, 745.14, 746.0, 2.0**20, 2.0**26, 2.0**53, 2.0**60, 1e22, 1e300),
    *(6381956970095103 * 2.0**797, 1.7976931348623157e308, math.inf, math.nan),
]
"""Bounds of the cases in the functions; the double that is nearest to a multiple of pi / 2."""


def call_all(calls: Any, n: Any) -> int:
    """Call every function with the arguments of each of ``n`` records."""
    for i in range(n):
        call = calls[i]
        call.sin = sin(call.x)
        call.cos = cos(call.x)
        call.tan = tan(call.x)
        call.asin = asin(call.x)
        call.acos = acos(call.x)
        call.atan = atan(call.x)
        call.exp = exp(call.x)
        call.log = log(call.x)
        call.atan2 = atan2(call.y, call.x)
        call.fmod = fmod(call.x, call.y)
    return 0


CALL_ALL: Any = kernel(call_all)
"""As this process runs kernels. It is not kept on disk: the key there knows no test."""
ENTRY = Entry(call_all, (CALL, int), True)
"""As a library is made of it."""


def any_double(rng: random.Random) -> float:
    """Any pattern of bits but NaN and infinity."""
    while True:
        (x,) = struct.unpack("<d", rng.randbytes(8))
        if math.isfinite(x):
            return float(x)


def angle(rng: random.Random) -> float:
    """An angle [rad]: usual, huge, or next to a multiple of pi / 2."""
    kinds = (
        rng.uniform(-math.pi, math.pi),
        rng.uniform(-1e4, 1e4),
        rng.randrange(1, 2 ** rng.randrange(2, 52)) * (math.pi / 2),
        math.ldexp(rng.uniform(1.0, 2.0), rng.randrange(-40, 1024)),
    )
    return rng.choice(kinds)


def share(rng: random.Random) -> float:
    """A number in [-1, 1]; many are near a bound or 0."""
    sizes = (
        rng.uniform(0.0, 1.0),
        1.0 - 2.0 ** rng.uniform(-53.0, -1.0),
        2.0 ** rng.uniform(-60.0, 0.0),
        rng.randrange(2**12) / 2**12,
    )
    return math.copysign(rng.choice(sizes), rng.uniform(-1.0, 1.0))


def exponent(rng: random.Random) -> float:
    """A number whose power of e is not infinite."""
    return rng.choice([rng.uniform(-745.2, 709.78), rng.uniform(-1.0, 1.0), share(rng)])


def positive(rng: random.Random) -> float:
    """A positive number; many are near 1."""
    near = 1.0 + share(rng) * 2.0 ** -rng.randrange(1, 52)
    return rng.choice([abs(any_double(rng)) or 1.0, rng.uniform(0.4, 2.1), near])


def side(rng: random.Random) -> float:
    """A coordinate of a point."""
    return rng.choice([any_double, angle, share])(rng)


def arguments(count: int = COUNT, seed: int = SEED) -> Records:
    """Return special arguments in all pairs, then random ones."""
    rng = random.Random(seed)
    both = [x * sign for x in SPECIAL for sign in (1.0, -1.0)]
    pairs = [(x, y) for x in both for y in both]
    kinds = [angle, share, exponent, positive, any_double]
    pairs += [(rng.choice(kinds)(rng), side(rng)) for _ in range(count)]
    calls = np.zeros(len(pairs), CALL)
    calls["x"], calls["y"] = np.array(pairs).T
    return calls


def digest(calls: Records) -> str:
    """Return a hash of every bit of the values; x and y are left out (a NaN has a sign there)."""
    return hashlib.sha256(b"".join(calls[name].tobytes() for name in NAMES)).hexdigest()


def main(words: list[str]) -> int:
    """Print the hash, or the IR."""
    if words == ["ir"]:
        from safety_island.targets.aot.ir import ir_of

        print(ir_of(ENTRY))
        return 0
    calls = arguments()
    CALL_ALL(calls, len(calls))
    print(digest(calls))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
