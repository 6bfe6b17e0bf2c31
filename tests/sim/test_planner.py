# SPDX-License-Identifier: Apache-2.0
"""The planner's window, its stops, and where it finds the vehicle."""

from __future__ import annotations

import math

import numpy as np
import pytest

from safety_island.sim.courses import load_course
from safety_island.sim.planner import Planner
from safety_island.sim.projection import locate
from safety_island.sim.shapes import SPACING


def _at(planner: Planner, station: float, aside: float = 0.0) -> tuple[float, float]:
    """Position [m] on the present leg, ``aside`` to the left."""
    leg = planner.leg
    index = round((station - leg.origin) / SPACING)
    point, following = leg.points[index], leg.points[min(index + 1, len(leg.points) - 1)]
    yaw = 2.0 * math.atan2(float(following["qz"]), float(following["qw"]))
    return float(point["x"]) - aside * math.sin(yaw), float(point["y"]) + aside * math.cos(yaw)


def _drive_to(planner: Planner, now: float, station: float) -> None:
    """Move along the leg to ``station`` in steps that the search can follow, then stand."""
    for place in np.arange(planner.place.station, station, 5.0):
        planner.update(now, *_at(planner, place), 5.0)
    planner.update(now, *_at(planner, station), 0.0)


@pytest.mark.parametrize("aside", [-1.0, -0.2, 0.0, 0.3])
def test_locates_beside_the_path(aside: float) -> None:
    planner = Planner(load_course("s-curve"))
    for station in np.arange(0.0, 270.0, 7.5):
        place = planner.update(0.0, *_at(planner, station, aside), 5.0)
        assert place.lateral_error == pytest.approx(aside, abs=0.01)
        assert place.station == pytest.approx(station, abs=0.03)


def test_locates_before_and_beyond_the_ends() -> None:
    leg = load_course("straight").legs[0]
    assert locate(leg, 0, -2.0, 0.5).station == pytest.approx(-12.0)
    beyond = locate(leg, len(leg.points) - 2, 360.3, -0.5)
    assert beyond.station == pytest.approx(350.3)
    assert beyond.lateral_error == pytest.approx(-0.5)
    assert beyond.speed == 0.0


def test_starts_at_the_start() -> None:
    planner = Planner(load_course("s-curve"))
    assert planner.start_pose() == pytest.approx((10.0, 0.0, 0.0))
    assert planner.place.station == pytest.approx(0.0)


def test_window_reaches_behind_and_ahead() -> None:
    planner = Planner(load_course("s-curve"), behind=10.0, ahead=100.0)
    planner.update(0.0, *_at(planner, 20.0), 5.0)
    window = planner.window()
    assert len(window) == pytest.approx(220, abs=1)
    assert window["x"][0] == pytest.approx(20.0, abs=SPACING)
    assert window["v"][-1] > 0.0


def test_window_ends_at_the_stop() -> None:
    planner = Planner(load_course("stop-and-go"))
    planner.update(0.0, *_at(planner, 30.0), 5.0)
    window = planner.window()
    assert window["v"][-1] == 0.0
    assert (window["v"][:-1] > 0.0).all()
    assert float(window["x"][-1]) == pytest.approx(_at(planner, planner.stop_station)[0])


def test_goes_on_after_the_dwell() -> None:
    planner = Planner(load_course("stop-and-go"), dwell=3.0)
    assert planner.stop_station == 50.0
    _drive_to(planner, 0.0, 50.0)
    assert planner.legs_done == 1
    assert planner.stop_errors == pytest.approx([0.0])
    planner.update(2.9, *_at(planner, 50.0), 0.0)
    assert planner.stop_station == 50.0
    planner.update(3.0, *_at(planner, 50.0), 0.0)
    assert planner.stop_station == 100.0
    assert (planner.window()["v"][:-1] > 0.0).all()
    assert planner.place.station == pytest.approx(50.0)


def test_standing_far_from_the_stop_is_no_stop() -> None:
    planner = Planner(load_course("stop-and-go"))
    _drive_to(planner, 0.0, 45.0)
    assert planner.legs_done == 0


def test_finishes_after_the_last_stop() -> None:
    planner = Planner(load_course("straight"))
    _drive_to(planner, 0.0, planner.stop_station)
    planner.update(100.0, *_at(planner, planner.stop_station), 0.0)
    assert planner.finished
    assert planner.lap == 0


def test_repeats_from_where_it_ended() -> None:
    """The second lap of the U-turn leads back, turned by half a circle."""
    course = load_course("u-turn")
    planner = Planner(course, repeat=True)
    end = course.legs[-1].points[-1]
    _drive_to(planner, 0.0, planner.stop_station)
    planner.update(3.0, float(end["x"]), float(end["y"]), 0.0)
    assert (planner.lap, planner.finished) == (1, False)
    assert planner.place.station == pytest.approx(0.0, abs=1e-6)
    assert planner.place.lateral_error == pytest.approx(0.0, abs=1e-6)
    window = planner.window()
    assert window["x"][-1] > window["x"][0] if end["qw"] > 0.9 else window["x"][-1] < window["x"][0]
    norm = window["qx"] ** 2 + window["qy"] ** 2 + window["qz"] ** 2 + window["qw"] ** 2
    assert norm == pytest.approx(1.0)
    azimuth = np.arctan2(np.diff(window["y"]), np.diff(window["x"]))
    yaw = 2.0 * np.arctan2(window["qz"], window["qw"])
    assert np.cos(azimuth - yaw[:-1]).min() > 0.99
