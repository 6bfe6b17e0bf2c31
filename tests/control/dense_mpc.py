# SPDX-License-Identifier: Apache-2.0
"""The MPC's models and quadratic programme written down with dense matrices, to compare with.

Nothing here is shared with the controller: models in continuous time, the bilinear transform by a
linear solve, the prediction matrices block by block, every weight as its own small matrix.
"""

from __future__ import annotations

import math
from functools import partial
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from safety_island.control.params import LateralParams, Parameters

Values = npt.NDArray[np.float64]
Model = tuple[Values, Values, Values]
"""A, B and W of x' = A x + B u + W."""


def continuous(p: Parameters, v: float, k: float) -> Model:
    """The model of a parameter set at speed v [m/s] on curvature k [1/m]."""
    wheelbase, limit = p.vehicle.wheel_base, p.vehicle.max_steer_angle
    angle = min(max(math.atan(wheelbase * k), -limit), limit)
    gain = 1.0 / (wheelbase * math.cos(angle) ** 2)
    if p.lateral.vehicle_model_type == "kinematics":
        v = math.copysign(max(abs(v), 1e-4), v if v != 0.0 else 1.0)
        tau = p.lateral.vehicle_model_steer_tau
        drift = -v * k + v * (math.tan(angle) / wheelbase - angle * gain)
        a = np.array([[0.0, v, 0.0], [0.0, 0.0, v * gain], [0.0, 0.0, -1.0 / tau]])
        return a, np.array([0.0, 0.0, 1.0 / tau]), np.array([0.0, drift, 0.0])
    if p.lateral.vehicle_model_type == "kinematics_no_delay":
        a = np.array([[0.0, v], [0.0, 0.0]])
        return a, np.array([0.0, v * gain]), np.array([0.0, -v * angle * gain])
    return _dynamics(p, max(v, 0.01), k)


def _dynamics(p: Parameters, v: float, k: float) -> Model:
    m, lf, lr, cf, cr = axles(p)
    inertia = lf**2 * m * lr / (lf + lr) + lr**2 * m * lf / (lf + lr)
    moment, square = lr * cr - lf * cf, lf**2 * cf + lr**2 * cr
    a = np.array(
        [
            [0.0, 1.0, 0.0, 0.0],
            [0.0, -(cf + cr) / (m * v), (cf + cr) / m, moment / (m * v)],
            [0.0, 0.0, 0.0, 1.0],
            [0.0, moment / (inertia * v), -moment / inertia, -square / (inertia * v)],
        ]
    )
    b = np.array([0.0, cf / m, 0.0, lf * cf / inertia])
    w = np.array([0.0, moment / (m * v) - v, 0.0, -square / (inertia * v)]) * k * v
    return a, b, w


def axles(p: Parameters) -> tuple[float, float, float, float, float]:
    """Mass [kg], distances of the axles from the centre of mass [m], cornering stiffnesses."""
    q = p.lateral
    front, rear = q.vehicle_mass_fl + q.vehicle_mass_fr, q.vehicle_mass_rl + q.vehicle_mass_rr
    m, wheelbase = front + rear, p.vehicle.wheel_base
    return m, wheelbase * rear / m, wheelbase * front / m, q.vehicle_cf, q.vehicle_cr


def bilinear(model: Model, dt: float) -> Model:
    """The discrete model for a step of dt [s]."""
    a, b, w = model
    one = np.eye(len(a))
    left = one - dt / 2.0 * a
    right = np.column_stack([one + dt / 2.0 * a, b * dt, w * dt])
    solved: Values = np.asarray(np.linalg.solve(left, right), np.float64)
    return solved[:, :-2], solved[:, -2], solved[:, -1]


def feed_forward(p: Parameters, v: float, k: float) -> float:
    """The steering angle that holds curvature k, zero when it is small."""
    angle = math.atan(p.vehicle.wheel_base * k)
    if p.lateral.vehicle_model_type == "dynamics":
        m, lf, lr, cf, cr = axles(p)
        wheelbase = p.vehicle.wheel_base
        understeer = lr * m / (2 * cf * wheelbase) - lf * m / (2 * cr * wheelbase)
        angle = wheelbase * k + understeer * v**2 * k
    return angle if abs(angle) >= math.radians(p.lateral.mpc_zero_ff_steer_deg) else 0.0


class Horizon(NamedTuple):
    """What the programme is made of: per step speed, curvature, feed-forward curvature."""

    v: Values
    k: Values
    k_steer: Values
    dt: float
    x0: Values


def programme(p: Parameters, horizon: Horizon) -> tuple[Values, Values]:
    """H (n, n) and f (n,) of ``min 1/2 u'Hu + f'u``."""
    n, states = len(horizon.v), len(horizon.x0)
    aex, bex, wex = _prediction(p, horizon)
    outputs = np.zeros((2, states))
    outputs[0, 0] = outputs[1, {2: 1, 3: 1, 4: 2}[states]] = 1.0
    c = np.kron(np.eye(n), outputs)
    q, r, changes = _weights(p, horizon)
    u_ref = [feed_forward(p, v, k) for v, k in zip(horizon.v, horizon.k_steer, strict=True)]
    cb = c @ bex
    h = cb.T @ q @ cb + r + changes
    f = (c @ (aex @ horizon.x0 + wex)) @ q @ cb - np.array(u_ref) @ r
    return h, f


def _prediction(p: Parameters, horizon: Horizon) -> Model:
    """All states from the first and all inputs: X = aex x0 + bex U + wex."""
    n, s = len(horizon.v), len(horizon.x0)
    aex, bex, wex = np.zeros((n * s, s)), np.zeros((n * s, n)), np.zeros(n * s)
    before_a, before_b, before_w = np.eye(s), np.zeros((s, n)), np.zeros(s)
    for i in range(n):
        a, b, w = bilinear(continuous(p, horizon.v[i], horizon.k[i]), horizon.dt)
        before_a, before_b, before_w = a @ before_a, a @ before_b, a @ before_w + w
        before_b[:, i] = b
        rows = slice(i * s, (i + 1) * s)
        aex[rows], bex[rows], wex[rows] = before_a, before_b, before_w
    return aex, bex, wex


def _weight(w: LateralParams, prefix: str, name: str) -> float:
    return float(getattr(w, f"mpc_{prefix}_{name}"))


def _weights(p: Parameters, horizon: Horizon) -> tuple[Values, Values, Values]:
    """Q on the outputs, R1 on the inputs off the feed-forward, R2 on their changes."""
    w, n, dt, period = p.lateral, len(horizon.v), horizon.dt, p.node.ctrl_period
    q, r, jerk = np.zeros((2 * n, 2 * n)), np.zeros((n, n)), np.zeros((n, n))
    for i, (v, k) in enumerate(zip(horizon.v, horizon.k, strict=True)):
        near_straight = abs(k) < w.mpc_low_curvature_thresh_curvature
        chosen = partial(_weight, w, "low_curvature_weight" if near_straight else "weight")
        lateral, heading = chosen("lat_error"), chosen("heading_error")
        if i == n - 1:
            lateral, heading = w.mpc_weight_terminal_lat_error, w.mpc_weight_terminal_heading_error
        q[2 * i, 2 * i] = lateral
        q[2 * i + 1, 2 * i + 1] = heading + v**2 * chosen("heading_error_squared_vel")
        r[i, i] += chosen("steering_input") + v**2 * chosen("steering_input_squared_vel")
        if i < n - 1:
            step = np.zeros(n)
            step[i : i + 2] = -1.0, 1.0
            jerk += v**2 * chosen("lat_jerk") / dt**2 * np.outer(step, step)
            r += w.mpc_weight_steer_rate / dt**2 * np.outer(step, step)
        if 0 < i < n - 1:
            bend = np.zeros(n)
            bend[i - 1 : i + 2] = 1.0, -2.0, 1.0
            r += w.mpc_weight_steer_acc / dt**4 * np.outer(bend, bend)
    r[0, 0] += w.mpc_weight_steer_rate / period**2
    a, mixed = w.mpc_weight_steer_acc / dt**4, w.mpc_weight_steer_acc / (dt**3 * period)
    r[0, 0] += a + 2.0 * mixed + w.mpc_weight_steer_acc * (1 / (dt * period) ** 2 + 1 / period**4)
    r[0, 1] -= a + mixed
    r[1, 0] -= a + mixed
    r[1, 1] += a
    return q, r, jerk
