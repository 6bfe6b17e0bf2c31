# SPDX-License-Identifier: Apache-2.0
"""The reference is worked out as far as it is asked for: what comes of it is the same."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from safety_island.control.reference_positions import ensure
from tests.control.lateral_rig import Rig, circle, line, make_points, on_path

COLUMNS = ("rx", "ry", "rz", "rv")
NEAR: dict[str, Any] = {"ego_nearest_dist_threshold": 3.0, "ego_nearest_yaw_threshold": 1.046}
"""As Autoware has it; without these limits the search for the ego asks for the whole reference."""


def state_of(rig: Rig) -> Any:
    """The state as the last tick left it; ``rig.lat`` would work the reference out."""
    return rig.follower._lateral[0]


def columns(lat: Any) -> Any:
    return np.array([lat[name][: lat.ref_n + 1] for name in COLUMNS])


def test_what_lies_beyond_the_horizon_costs_nothing() -> None:
    rig = on_path(line(400.0), **NEAR)
    rig.tick()
    lat = state_of(rig)
    assert lat.ref_n == 4000 and lat.segment + lat.window < lat.ready < 1000


@pytest.mark.parametrize("stride", [1, 63, 64, 65, 1000])
def test_any_stride_gives_the_same_bits(stride: int) -> None:
    path = circle(40.0, 120.0, 0.7, v=3.0)
    rig, whole = on_path(path, **NEAR), on_path(path, **NEAR)
    rig.tick()
    whole.tick()
    lat = state_of(rig)
    for i in range(0, lat.ref_n + stride, stride):
        assert ensure(lat, i) > min(i, lat.ref_n)
    np.testing.assert_array_equal(columns(lat), columns(whole.lat))


def test_the_end_is_closed_once_it_is_reached() -> None:
    rig = on_path(line(50.0), **NEAR)
    assert rig.lat.ref_n == rig.lat.ready == 0, "nothing is there before the first tick"
    rig.tick()
    lat = state_of(rig)
    assert ensure(lat, lat.ref_n - 1) == ensure(lat, lat.ref_n + 5) == lat.ref_n + 1
    end = columns(lat)[:, -2:]
    np.testing.assert_array_equal(end[:, 0], end[:, 1])
    assert end[3, 0] == 0.0


def test_a_path_of_no_length_leaves_the_whole_of_the_one_before() -> None:
    """Its points replace those from which the rest of the reference would have been worked out."""
    rig, twin = on_path(line(300.0), **NEAR), on_path(line(300.0), **NEAR)
    rig.tick()
    twin.tick()
    rig.path(make_points([0.0, 2e-7, 4e-7], yaw=0.0))
    rig.tick()
    assert state_of(rig).ready == state_of(rig).ref_n + 1
    np.testing.assert_array_equal(columns(state_of(rig)), columns(twin.lat))
