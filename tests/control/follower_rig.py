# SPDX-License-Identifier: Apache-2.0
"""A follower that drives, what it remembers, and whether that is made of numbers."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from safety_island.control.follower import TrajectoryFollower
from tests.control.lateral_rig import PERIOD, START, line
from tests.golden.harness import firmware


def memory(follower: TrajectoryFollower) -> tuple[Any, ...]:
    """Everything that a refused input must leave as it was, bit for bit."""
    records = (
        *(follower.inputs, follower.points, follower.command, follower.trace),
        *(follower._lateral, follower._longitudinal, follower._work, follower._qp),
    )
    parts = [part for each in records for part in (each if isinstance(each, tuple) else (each,))]
    return (*(part.tobytes() for part in parts), follower.missing(), follower.is_ready())


def driving(**overrides: Any) -> TrajectoryFollower:
    """Five ticks on a straight road, beside it."""
    follower = TrajectoryFollower(firmware(**overrides))
    follower.offer_operation_mode(2, True)
    follower.offer_trajectory(line(80.0, v=4.0), START)
    follower.offer_steering(0.01)
    follower.offer_acceleration(0.1)
    for i in range(5):
        follower.offer_odometry(0.5 * i, 0.2, 0.0, 0.0, 0.0, 0.0, 1.0, 3.0, 0.0, 0.01)
        assert follower.step(START + PERIOD * i)
    return follower


def numbers(values: Any) -> Iterator[Any]:
    """Every floating-point column of a record, those of the records inside it included."""
    for name in values.dtype.names or ():
        kind = values.dtype[name].base.kind
        if kind == "f":
            yield values[name]
        elif kind == "V":
            yield from numbers(values[name])


def finite(follower: TrajectoryFollower) -> bool:
    """Whether every number of the command and of both memories is one."""
    records = (follower.command, follower._lateral, follower._longitudinal)
    return all(np.isfinite(column).all() for each in records for column in numbers(each))
