# SPDX-License-Identifier: Apache-2.0
"""Pieces of road as curvature and grade along the arc length, and the path they make together.

A piece is sampled every ``SPACING`` metres. Curvature changes by smooth ramps (continuous with its
first derivative), so that a steering actuator can follow it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

SPACING = 0.5
"""Distance of two path points [m]."""

_FINE = 20
"""Integration steps between two path points."""


class Piece(NamedTuple):
    """Curvature [1/m] and grade [-] at the middle of each integration step."""

    curvature: Floats
    grade: Floats


def _middles(length: float) -> Floats:
    """Arc lengths [m] of the middles of the steps of a piece; the length is a whole SPACING."""
    count = round(length / SPACING) * _FINE
    return np.asarray((np.arange(count) + 0.5) * (SPACING / _FINE), np.float64)


def _ramp(t: Floats) -> Floats:
    """0 to 1 with zero slope at both ends; its mean is one half."""
    t = np.clip(t, 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def straight(length: float) -> Piece:
    """Go straight on for ``length`` [m]."""
    s = _middles(length)
    return Piece(np.zeros_like(s), np.zeros_like(s))


def turn(degrees: float, length: float, ramp: float) -> Piece:
    """Change the heading by ``degrees`` (left positive) over ``length`` [m].

    The curvature rises and falls over ``ramp`` [m] each; between, it is angle / (length - ramp).
    """
    s = _middles(length)
    shape = _ramp(s / ramp) * _ramp((s[-1] + s[0] - s) / ramp)
    total = np.radians(degrees) / (SPACING / _FINE)
    return Piece(shape * (total / shape.sum()), np.zeros_like(s))


def shift(offset: float, length: float) -> Piece:
    """Move ``offset`` [m] to the left over ``length`` [m] of road; the heading ends as it began.

    The offset is a quintic polynomial of the arc length s, y(s); its curvature is
    y'' / sqrt(1 - y'^2), because y' is the sine of the heading.
    """
    s = _middles(length)
    t = s / length
    sine = offset / length * 30.0 * t**2 * (1.0 - t) ** 2
    second = offset / length**2 * 60.0 * t * (1.0 - t) * (1.0 - 2.0 * t)
    return Piece(second / np.sqrt(1.0 - sine**2), np.zeros_like(s))


def climb(grade: float, length: float, ramp: float) -> Piece:
    """Go straight on a slope of ``grade`` (0.08: 8 % up), smoothly entered and left."""
    s = _middles(length)
    shape = _ramp(s / ramp) * _ramp((s[-1] + s[0] - s) / ramp)
    return Piece(np.zeros_like(s), grade * shape)


@dataclass(frozen=True)
class Path:
    """Points every SPACING metres: position [m], yaw [rad], curvature [1/m], grade [-]."""

    x: Floats
    y: Floats
    z: Floats
    yaw: Floats
    curvature: Floats
    grade: Floats


def _at_points(middles: Floats) -> Floats:
    """Values at the path points from those at the middles of the integration steps."""
    padded = np.concatenate([middles[:1], middles, middles[-1:]])
    means: Floats = 0.5 * (padded[:-1] + padded[1:])
    return means[::_FINE]


def join(pieces: tuple[Piece, ...]) -> Path:
    """Integrate the pieces, one after the other, from the origin along x."""
    curvature = np.concatenate([piece.curvature for piece in pieces])
    grade = np.concatenate([piece.grade for piece in pieces])
    step = SPACING / _FINE
    yaw = np.concatenate([[0.0], np.cumsum(curvature) * step])
    middle = yaw[:-1] + 0.5 * step * curvature
    flat = step * np.cos(np.arctan(grade))
    columns = [flat * np.cos(middle), flat * np.sin(middle), flat * grade]
    x, y, z = (np.concatenate([[0.0], np.cumsum(column)])[::_FINE] for column in columns)
    return Path(x, y, z, yaw[::_FINE], _at_points(curvature), _at_points(grade))
