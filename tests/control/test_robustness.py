# SPDX-License-Identifier: Apache-2.0
"""What one odd input or a badly conditioned problem must not do to what the kernels remember."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.control.lateral_rig import START, Rig, line, make_points
from tests.control.test_daqp import append_constraint, fresh


def test_a_stamp_from_the_future_does_not_hold_the_shape_changed() -> None:
    rig = Rig()
    rig.path(line(50.0), stamp=START + 1e6)
    rig.tick()
    for tick in range(3):
        rig.path(line(60.0), stamp=START + 0.1 * tick)
        trace = rig.tick()
    assert not trace.shape_changed


def test_a_planner_whose_clock_was_set_back_is_not_held_as_changed() -> None:
    rig = Rig()
    for tick in range(5):
        rig.path(line(50.0), stamp=START + 0.1 * tick)
        rig.tick()
    rig.path(line(60.0), stamp=START - 500.0)
    assert not rig.tick().shape_changed


def test_an_end_that_moves_within_a_second_still_counts_as_changed() -> None:
    rig = Rig()
    rig.path(line(50.0), stamp=START)
    rig.tick()
    rig.path(line(60.0), stamp=START + 0.5)
    assert rig.tick().shape_changed


def test_a_full_working_set_takes_no_further_row_whatever_rounding_says() -> None:
    q = fresh(2, 1)
    assert append_constraint.call(q, 2, 0, 0) == 1
    assert append_constraint.call(q, 2, 1, 1) == 1
    q[0].qp_M[:2] = 0.0  # so that nothing of a third row seems to lie in the set
    q[0].qp_L[:] = 0.0
    assert append_constraint.call(q, 2, 2, 65) == 0


@pytest.mark.parametrize("yaw", [math.pi / 2, -2.0])
def test_both_yaws_of_a_short_reference_come_from_its_own_trajectory(yaw: float) -> None:
    along = np.arange(0.0, 2.9, 0.02)
    rig = Rig(traj_resample_dist=1.0)
    rig.path(make_points(math.cos(yaw) * along, math.sin(yaw) * along, yaw=yaw))
    rig.place(0.9 * math.cos(yaw), 0.9 * math.sin(yaw), yaw)
    rig.tick()
    assert rig.lat.ref_n == 2
    assert rig.lat.short_yaw == pytest.approx([yaw, yaw])
