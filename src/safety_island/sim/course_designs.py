# SPDX-License-Identifier: Apache-2.0
"""The shapes of the courses: pieces of road, cruise speed, stops on the way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from safety_island.sim.shapes import Piece, climb, shift, straight, turn


@dataclass(frozen=True)
class Design:
    """A course before its points are made; speed in m/s."""

    summary: str
    cruise: float
    pieces: Callable[[], tuple[Piece, ...]]
    stops: tuple[float, ...] = ()
    """Stations [m] of the stops before the last."""


def _s_curve() -> tuple[Piece, ...]:
    left, right = turn(70.0, 50.0, 15.0), turn(-70.0, 50.0, 15.0)
    return straight(30.0), left, right, straight(20.0), right, left, straight(30.0)


def _lane_change() -> tuple[Piece, ...]:
    over, back = shift(3.5, 50.0), shift(-3.5, 50.0)
    return straight(75.0), over, straight(50.0), back, straight(50.0), over, straight(90.0)


def _u_turn() -> tuple[Piece, ...]:
    around, over = turn(180.0, 40.0, 10.0), shift(-3.5, 40.0)
    return straight(80.0), around, straight(70.0), over, straight(40.0)


def _stop_and_go() -> tuple[Piece, ...]:
    left, right = turn(45.0, 40.0, 12.0), turn(-45.0, 40.0, 12.0)
    return straight(30.0), left, straight(12.0), right, straight(20.0)


def _slalom() -> tuple[Piece, ...]:
    swing = (shift(3.0, 32.0), shift(-3.0, 32.0))
    return straight(35.0), *swing * 4, straight(40.0)


def _hill() -> tuple[Piece, ...]:
    up, down = climb(0.08, 80.0, 12.0), climb(-0.06, 55.0, 12.0)
    return straight(30.0), up, straight(15.0), down, straight(30.0)


DESIGNS: dict[str, Design] = {
    "s-curve": Design("two S-bends with a radius of 29 m", 8.0, _s_curve),
    "lane-change": Design("three lane changes of 3.5 m at 12 m/s", 12.0, _lane_change),
    "u-turn": Design("a U-turn with a radius of 9.5 m", 8.0, _u_turn),
    "stop-and-go": Design("two stops on the way, both in a bend", 7.0, _stop_and_go, (50.0, 100.0)),
    "slalom": Design("eight swings of 3 m", 8.0, _slalom),
    "hill": Design("8 % up, a stop on the slope, 6 % down", 7.0, _hill, (75.0,)),
    "straight": Design("a straight road", 10.0, lambda: (straight(350.0),)),
}
"""Every course by its name."""
