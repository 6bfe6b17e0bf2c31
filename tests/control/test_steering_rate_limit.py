# SPDX-License-Identifier: Apache-2.0
"""Bounds of the programme: angle, and rate by curvature and speed."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from safety_island.control.records import pack_parameters
from safety_island.control.steering_rate_limit import rate_limit
from tests.control.lateral_rig import Rig, circle, make_points, on_path
from tests.golden.harness import firmware


def limit(v: float, k: float, **overrides: Any) -> float:
    """The limit in degrees a second."""
    return math.degrees(rate_limit(pack_parameters(firmware(**overrides))[0], v, k))


@pytest.mark.parametrize(
    ("k", "degrees"),
    [(0.0, 40), (0.001, 40), (0.0015, 45), (0.002, 50), (0.006, 55), (0.01, 60), (0.5, 60)],
)
def test_between_the_entries_of_the_curvature_it_is_linear(k: float, degrees: float) -> None:
    """Beyond either end the end's own value holds."""
    assert limit(0.0, k) == pytest.approx(degrees, rel=1e-12)


@pytest.mark.parametrize(
    ("v", "degrees"),
    [(0.0, 60), (10.0, 60), (12.5, 55), (15.0, 50), (19.0, 42), (20, 40), (60, 40)],
)
def test_between_the_entries_of_the_speed_it_is_linear(v: float, degrees: float) -> None:
    assert limit(v, 1.0) == pytest.approx(degrees, rel=1e-12)


def test_the_smaller_of_both_holds() -> None:
    assert limit(15.0, 0.001) == pytest.approx(40.0)
    assert limit(20.0, 0.01) == pytest.approx(40.0)
    assert limit(15.0, 0.01) == pytest.approx(50.0)


def test_the_firmware_looks_both_up_with_their_sign() -> None:
    """So right curves get the first entry of the one table, reverse that of the other."""
    assert limit(5.0, -0.5) == pytest.approx(40.0)
    assert limit(-25.0, 0.5) == pytest.approx(60.0)


@pytest.mark.parametrize("v", [0.0, 7.0, 12.5, 30.0])
@pytest.mark.parametrize("k", [0.0, 0.0015, 0.006, 0.3])
def test_symmetric_limits_know_no_side(v: float, k: float) -> None:
    sides = {
        limit(a * v, b * k, symmetric_steer_rate_limits=True) for a in (1, -1) for b in (1, -1)
    }
    assert sides == {limit(v, k)}


def test_a_table_of_one_entry_is_a_constant() -> None:
    table = {
        "steer_rate_lim_dps_list_by_curvature": (33.0,),
        "curvature_list_for_steer_rate_lim": (0.01,),
    }
    for k in (-1.0, 0.0, 0.01, 0.02):
        assert limit(0.0, k, **table) == pytest.approx(33.0)


def bounds(rig: Rig) -> Any:
    n = rig.parameters.lateral.mpc_prediction_horizon
    return {key: np.array(rig.qp[key][:n]) for key in ("lb", "ub", "lbA", "ubA")}


def test_the_first_change_counts_from_the_last_solution_over_a_control_period() -> None:
    """The others are a prediction step long."""
    rig = on_path(circle(30.0, 60.0, v=12.5), qp_solver_type="daqp")
    rig.place(10.0, 1.7, 0.34, vx=12.5)
    previous = [rig.tick().raw_steer_cmd_prev, rig.tick()][0]
    found, dt = bounds(rig), rig.lat.prediction_dt
    rates = [math.radians(limit(v, k)) for v, k in zip(rig.lat.hv, rig.lat.hk, strict=True)][:50]
    steps = np.array([rates[0] * rig.period, *(rate * dt for rate in rates[1:])])
    centre = np.array([previous] + [0.0] * 49)
    np.testing.assert_allclose(found["ubA"], centre + steps, rtol=0, atol=1e-14)
    np.testing.assert_allclose(found["lbA"], centre - steps, rtol=0, atol=1e-14)
    assert rates[0] == pytest.approx(math.radians(55.0), abs=0.01)
    np.testing.assert_array_equal(found["ub"], 0.70)
    np.testing.assert_array_equal(found["lb"], -0.70)


@pytest.mark.parametrize(("speed", "rate"), [(0.0, 100.0), (-0.0099, 100.0), (0.01, 0.0)])
def test_a_vehicle_at_rest_may_turn_its_wheels_at_once(speed: float, rate: float) -> None:
    """Below 0.01 m/s; from there on the tables hold."""
    rig = on_path(circle(30.0, 30.0))
    rig.place(vx=speed)
    rig.tick()
    rate = rate or math.radians(limit(rig.lat.hv[1], rig.lat.hk[1]))
    assert bounds(rig)["ubA"][1] == pytest.approx(rate * rig.lat.prediction_dt, rel=1e-12)


def test_the_solution_runs_along_the_rate_limit() -> None:
    """From 3 m off, an exact solver turns by 60 degrees a second and says so."""
    tables = {"steer_rate_lim_dps_list_by_curvature": (60.0, 60.0, 60.0)}
    rig = on_path(make_points(np.arange(60.0), v=3.0), qp_solver_type="daqp", **tables)
    rig.place(5.0, 3.0, vx=3.0)
    step = math.radians(60.0) * rig.period
    for i, trace in enumerate(rig.ticks(3)):
        assert trace.u[0] == pytest.approx(-step * (i + 1), abs=1e-9)
        assert trace.rate_limited and trace.active_constraints > 0


@pytest.mark.parametrize(("y", "steer"), [(-4.9, 0.70), (4.9, -0.70)])
def test_without_rate_limits_the_angle_is_clamped_and_says_so(y: float, steer: float) -> None:
    rig = on_path(make_points(np.arange(60.0), v=2.0))
    rig.place(5.0, y, vx=2.0)
    trace = rig.tick()
    assert trace.angle_limited
    assert not trace.rate_limited, "there is none"
    assert abs(trace.u[0]) > 0.70 and trace.raw_steer_cmd_prev == trace.u[0], "kept unclamped"
    assert rig.angle == np.float32(steer)
