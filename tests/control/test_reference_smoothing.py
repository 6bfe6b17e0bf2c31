# SPDX-License-Identifier: Apache-2.0
"""The optional shaping of the reference path: moving average and terminal extension."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.control.lateral_rig import (
    arc_of,
    circle,
    column,
    make_points,
    on_path,
    stations,
)


def test_smoothing_is_the_mean_over_a_window_that_shrinks_at_the_ends() -> None:
    x = np.arange(0.0, 30.0, 0.5)
    zigzag = make_points(x, np.where(np.arange(60) % 4 < 2, 0.0, 0.1), v=2.0 + np.sin(x), yaw=0.0)
    plain = on_path(zigzag)
    smooth = on_path(zigzag, enable_path_smoothing=True, path_filter_moving_ave_num=10)
    for rig in (plain, smooth):
        rig.tick()
    n = plain.lat.ref_n
    for name in ("rx", "ry", "rv"):
        raw = column(plain, name)
        if name == "rv":
            raw[-1] = np.interp(stations(plain)[-1], arc_of(zigzag), zigzag["v"])
        reach = [min(10, i, n - 1 - i) for i in range(n)]
        mean = np.array([raw[i - r : i + r + 1].mean() for i, r in enumerate(reach)])
        if name == "rv":
            mean[-1] = 0.0
        np.testing.assert_allclose(column(smooth, name), mean, rtol=0, atol=1e-13)


@pytest.mark.parametrize(("reach", "smoothed"), [(24, True), (25, False), (26, False)])
def test_a_path_is_smoothed_when_it_has_more_than_twice_the_reach(
    reach: int, smoothed: bool
) -> None:
    points = circle(5.0, 5.01)
    plain = on_path(points)
    other = on_path(points, enable_path_smoothing=True, path_filter_moving_ave_num=reach)
    for rig in (plain, other):
        rig.tick()
    assert plain.lat.ref_n == 50
    assert bool((column(plain, "ry") != column(other, "ry")).any()) == smoothed


@pytest.mark.parametrize(("yaw", "sign"), [(0.0, 1.0), (math.pi, -1.0)])
def test_the_extension_goes_ten_metres_along_the_last_yaw(yaw: float, sign: float) -> None:
    points = make_points(np.arange(0.0, 10.0), v=sign, yaw=yaw)
    points["qz"][-1], points["qw"][-1] = math.sin((yaw + 0.3) / 2), math.cos((yaw + 0.3) / 2)
    rig = on_path(points, extend_trajectory_for_end_yaw_control=True)
    rig.place(yaw=yaw)
    rig.tick()
    n = rig.lat.ref_n - 100
    x, y, v = (column(rig, name) for name in ("rx", "ry", "rv"))
    steps = np.arange(1, 101) * 0.1
    np.testing.assert_allclose(x[n:] - x[n - 1], steps * math.cos(0.3), rtol=0, atol=1e-12)
    np.testing.assert_allclose(y[n:] - y[n - 1], steps * math.sin(0.3), rtol=0, atol=1e-12)
    assert (v[n:-1] == 10.0).all() and v[-1] == 0.0
