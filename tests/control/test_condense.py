# SPDX-License-Identifier: Apache-2.0
"""H and f of the MPC against a construction with dense matrices, over random drives."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from safety_island.control.condense import is_finite_problem
from safety_island.control.status import MpcStatus
from safety_island.kernel.records import Records
from tests.control import dense_mpc
from tests.control.lateral_rig import Rig, Values, make_points, on_path
from tests.control.vehicles import FRONT_HEAVY

WEIGHTS = (
    *("lat_error", "heading_error", "heading_error_squared_vel"),
    *("steering_input", "steering_input_squared_vel", "lat_jerk", "steer_rate"),
)
MODELS = ("kinematics", "kinematics_no_delay", "dynamics")


def random_weights(rng: np.random.Generator) -> dict[str, float]:
    """Every weight of both sets, and a threshold between them that both sides of meet."""
    values = {f"mpc_weight_{name}": rng.uniform(0.0, 2.0) for name in WEIGHTS}
    values |= {f"mpc_low_curvature_weight_{name}": rng.uniform(0.0, 2.0) for name in WEIGHTS[:6]}
    values |= {"mpc_weight_steer_acc": 10.0 ** rng.uniform(-6, -3)}
    values |= {f"mpc_weight_terminal_{name}": rng.uniform(0.0, 3.0) for name in WEIGHTS[:2]}
    return values | {"mpc_low_curvature_thresh_curvature": 0.03}


def random_path(rng: np.random.Generator, sign: float) -> Records:
    """A path that bends both ways, with a speed that changes at random."""
    s = np.arange(0.0, 80.0, 0.5)
    heading = np.cumsum(rng.normal(0.0, 0.02, len(s)) + 0.03 * np.sin(s / 10.0))
    x, y = np.cumsum(0.5 * np.cos(heading)), np.cumsum(0.5 * np.sin(heading))
    yaw = heading if sign > 0.0 else heading + math.pi
    return make_points(x, y, sign * rng.uniform(0.0, 9.0, len(s)), yaw)


def random_rig(seed: int, model: str, **overrides: Any) -> Rig:
    """A vehicle somewhere near such a path; an odd seed drives backward."""
    rng = np.random.default_rng(seed)
    sign = -1.0 if seed % 2 else 1.0
    overrides = random_weights(rng) | {"vehicle_model_type": model} | FRONT_HEAVY | overrides
    horizon = {"mpc_prediction_horizon": int(rng.choice([2, 3, 11, 50, 64]))}
    rig = on_path(random_path(rng, sign), **(horizon | overrides))
    at = rig.follower.points[20]
    yaw = 2.0 * math.atan2(at.qz, at.qw) + rng.normal(0.0, 0.2)
    rig.place(at.x + rng.normal(), at.y + rng.normal(), yaw, sign * rng.uniform(0.0, 8.0))
    rig.steer(rng.normal(0.0, 0.1))
    return rig


def horizon_of(rig: Rig) -> dense_mpc.Horizon:
    lat, n = rig.lat, rig.parameters.lateral.mpc_prediction_horizon
    sign = 1.0 if lat.is_forward else -1.0
    states = {"kinematics": 3, "kinematics_no_delay": 2, "dynamics": 4}
    size = states[rig.parameters.lateral.vehicle_model_type]
    return dense_mpc.Horizon(
        np.array(lat.hv[:n]),
        sign * np.array(lat.hk[:n]),
        sign * np.array(lat.hks[:n]),
        float(lat.prediction_dt),
        np.array(lat.x0_delayed[:size]),
    )


def check(rig: Rig) -> None:
    n = rig.parameters.lateral.mpc_prediction_horizon
    h, f = dense_mpc.programme(rig.parameters, horizon_of(rig))
    for found, wanted in ((rig.qp.H[:n, :n], h), (rig.qp.f[:n], f)):
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-11 * np.abs(wanted).max())
    np.testing.assert_array_equal(rig.qp.H[:n, :n], rig.qp.H[:n, :n].T)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("seed", range(12))
def test_the_programme_is_that_of_the_dense_matrices(model: str, seed: int) -> None:
    rig = random_rig(seed, model)
    for _ in range(3):
        rig.tick()
        assert rig.lat.is_forward == (seed % 2 == 0)
        check(rig)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("seed", range(4))
def test_it_is_with_a_delay_too(model: str, seed: int) -> None:
    """The state that the commands under way lead to, step by step of one period."""
    rig = random_rig(seed, model, input_delay=0.45, curvature_smoothing_num_ref_steer=35)
    assert rig.lat.delay_n == 3
    for _ in range(5):
        pending = np.array(rig.lat.delay[:3], float)
        rig.tick()
        check(rig)
        np.testing.assert_allclose(horizon_of(rig).x0, led_through(rig, pending), atol=1e-12)


def led_through(rig: Rig, pending: Values) -> Values:
    """The initial state after the commands under way, along the filtered path."""
    lat, period = rig.lat, rig.period
    n = lat.window
    sign = 1.0 if lat.is_forward else -1.0
    k = np.array([np.nan] * n)
    x = np.array(lat.x0[: len(horizon_of(rig).x0)])
    reach = rig.parameters.lateral.curvature_smoothing_num_traj
    for i, command in enumerate(pending):
        t = lat.nearest_time + i * period
        j = min(int(np.searchsorted(lat.wt[:n], t)), n - 1)
        for w in (j - 1, j):
            k[w] = menger(rig, lat.segment + w, reach)
        around = slice(j - 1, j + 1)
        v = np.interp(t, lat.wt[:n][around], lat.wv[:n][around])
        bend = sign * np.interp(t, lat.wt[:n][around], k[around])
        a, b, w_ = dense_mpc.bilinear(dense_mpc.continuous(rig.parameters, v, bend), period)
        x = a @ x + b * command + w_
    return x


def menger(rig: Rig, i: int, reach: int) -> float:
    """Four times the area of the triangle of three points over the product of its sides."""
    n = rig.lat.ref_n
    span = min(reach, (n - 1) // 2)
    i = min(max(i, span), n - 1 - span)
    p = [complex(rig.lat.rx[j], rig.lat.ry[j]) for j in (i - span, i, i + span)]
    area = ((p[1] - p[0]).conjugate() * (p[2] - p[0])).imag / 2.0
    return 4.0 * area / (abs(p[1] - p[0]) * abs(p[2] - p[1]) * abs(p[2] - p[0]))


def test_the_firmwares_own_weights_at_standstill() -> None:
    """v = 0: the steering moves nothing, so H is R alone and the pull to zero is in (0, 0)."""
    rig = on_path(make_points(np.arange(30.0), v=0.0), mpc_prediction_horizon=3)
    rig.place(0.0, 0.5, vx=0.0)
    rig.tick()
    assert rig.status is MpcStatus.SOLVED
    dt, period, w = rig.lat.prediction_dt, rig.period, 1e-6
    a = w / dt**4
    pull = a + w / (dt * period) ** 2 + 2 * w / (dt**3 * period) + w / period**4
    expected = np.eye(3) + a * np.outer([1.0, -2.0, 1.0], [1.0, -2.0, 1.0])
    expected[0, 0] += pull
    expected[0, 1] -= a + w / (dt**3 * period)
    expected[1, 0] = expected[0, 1]
    expected[1, 1] += a
    np.testing.assert_allclose(rig.qp.H[:3, :3], expected, rtol=0, atol=1e-7)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("place", ["diagonal", "below", "gradient"])
def test_a_problem_with_a_number_that_is_none_is_told(value: float, place: str) -> None:
    h, f = np.eye(4), np.zeros(4)
    assert is_finite_problem(h, f, 4)
    if place == "gradient":
        f[3] = value
    else:
        h[3, 3 if place == "diagonal" else 1] = value
    assert not is_finite_problem(h, f, 4)
    assert is_finite_problem(h, f, 3), "what lies outside the problem does not count"
