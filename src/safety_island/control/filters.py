# SPDX-License-Identifier: Apache-2.0
"""Second-order Butterworth low pass of the lateral controller."""

import math

from safety_island.kernel.kernel import kernel
from safety_island.kernel.math.trigonometric import tan


@kernel
def butterworth(memory, u, cutoff_hz, period):
    """Filter one sample; ``memory`` is a FILTER record.

    At or above the Nyquist frequency 1/(2 period) the input passes: the bilinear filter would be
    unstable or degenerate there (the firmware's own 10 Hz at 0.15 s amounts to passing it on).
    """
    if cutoff_hz * 2.0 * period >= 1.0:
        return u
    xi = 1.0 / tan(math.pi * cutoff_hz * period)
    b0 = 1.0 / (1.0 + math.sqrt(2.0) * xi + xi * xi)
    a1 = 2.0 * (xi * xi - 1.0) * b0
    a2 = -(1.0 - math.sqrt(2.0) * xi + xi * xi) * b0
    y = b0 * u + 2.0 * b0 * memory.u1 + b0 * memory.u2 + a1 * memory.y1 + a2 * memory.y2
    memory.u2 = memory.u1
    memory.u1 = u
    memory.y2 = memory.y1
    memory.y1 = y
    return y
