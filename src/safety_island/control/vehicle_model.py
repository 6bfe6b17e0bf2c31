# SPDX-License-Identifier: Apache-2.0
"""The three prediction models of the MPC, discretised by the bilinear transform.

States: kinematics [lateral error, yaw error, steering angle]; kinematics without delay [lateral
error, yaw error]; dynamics [lateral error, its rate, yaw error, its rate]. All are kept in
matrices of four rows, the unused ones zero.
"""

import math

from safety_island.control.status import VehicleModel
from safety_island.kernel.kernel import kernel
from safety_island.kernel.math.inverse import atan
from safety_island.kernel.math.trigonometric import tan

_KINEMATICS = int(VehicleModel.KINEMATICS)
_NO_DELAY = int(VehicleModel.KINEMATICS_NO_DELAY)
_STATES = 4


@kernel
def is_kinematic(params):
    """Whether the chosen model is one of the two kinematic ones."""
    return params.vehicle_model_type <= _NO_DELAY


@kernel
def _steering_of(params, k):
    """Tyre angle [rad] that holds the curvature ``k`` [1/m], as far as it can be steered, its
    tangent, and the square of its secant.
    """
    tangent = params.wheel_base * k
    angle = atan(tangent)
    limit = params.max_steer_angle
    if abs(angle) > limit:
        angle = math.copysign(limit, angle)
        tangent = tan(angle)
    return angle, tangent, 1.0 + tangent * tangent


@kernel
def _kinematics(params, v, k, dt, a, b, w):
    """Kinematic bicycle with first-order steering: the transform in closed form."""
    wheelbase = params.wheel_base
    if abs(v) < 1e-4:
        v = -1e-4 if v < 0.0 else 1e-4
    angle, tangent, secant_squared = _steering_of(params, k)
    c = v / wheelbase * secant_squared
    w1 = -v * k + v / wheelbase * (tangent - angle * secant_squared)
    h = 0.5 * dt
    tau = params.vehicle_model_steer_tau
    g = 1.0 / (1.0 + h / tau)
    a[0, 0] = 1.0
    a[0, 1] = dt * v
    a[0, 2] = 2.0 * g * h * h * v * c
    a[1, 1] = 1.0
    a[1, 2] = dt * g * c
    a[2, 2] = g * (1.0 - h / tau)
    b[0] = dt / tau * h * h * v * c * g
    b[1] = dt / tau * h * c * g
    b[2] = dt / tau * g
    w[0] = dt * h * v * w1
    w[1] = dt * w1
    w[2] = 0.0


@kernel
def _kinematics_no_delay(params, v, k, dt, a, b, w):
    """Kinematic bicycle whose steering follows at once."""
    wheelbase = params.wheel_base
    angle, _, secant_squared = _steering_of(params, k)
    c = v / wheelbase * secant_squared
    w1 = -v / wheelbase * angle * secant_squared
    h = 0.5 * dt
    a[0, 0] = 1.0
    a[0, 1] = dt * v
    a[1, 1] = 1.0
    b[0] = dt * h * v * c
    b[1] = dt * c
    w[0] = dt * h * v * w1
    w[1] = dt * w1


@kernel
def axle_masses(params):
    """Mass on the front and on the rear axle [kg]."""
    front = params.vehicle_mass_fl + params.vehicle_mass_fr
    return front, params.vehicle_mass_rl + params.vehicle_mass_rr


@kernel
def _dynamics(params, v, k, dt, work, a, b, w):
    """Linear tyre bicycle in error coordinates; solved numerically by ``_bilinear``."""
    mf, mr = axle_masses(params)
    mass = mf + mr
    lf = params.wheel_base * (1.0 - mf / mass)
    lr = params.wheel_base * (1.0 - mr / mass)
    inertia = lf * lf * mf + lr * lr * mr
    cf = params.vehicle_cf
    cr = params.vehicle_cr
    v = max(v, 0.01)
    cross = lr * cr - lf * cf
    square = lf * lf * cf + lr * lr * cr
    a[:, :] = 0.0
    a[0, 1] = 1.0
    a[1, 1] = -(cf + cr) / (mass * v)
    a[1, 2] = (cf + cr) / mass
    a[1, 3] = cross / (mass * v)
    a[2, 3] = 1.0
    a[3, 1] = cross / (inertia * v)
    a[3, 2] = -cross / inertia
    a[3, 3] = -square / (inertia * v)
    b[:] = 0.0
    b[1] = cf / mass
    b[3] = lf * cf / inertia
    w[:] = 0.0
    w[1] = (cross / (mass * v) - v) * k * v
    w[3] = -square / (inertia * v) * k * v
    _bilinear(work, a, b, w, dt)


@kernel
def _bilinear(work, a, b, w, dt):
    """Replace (a, b, w) by inv(I - dt/2 a) (I + dt/2 a, b dt, w dt); Gauss with row pivots."""
    n = 4
    h = 0.5 * dt
    for i in range(n):
        for j in range(n):
            one = 1.0 if i == j else 0.0
            work[i, j] = one - h * a[i, j]
            work[i, n + j] = one + h * a[i, j]
        work[i, 2 * n] = b[i] * dt
        work[i, 2 * n + 1] = w[i] * dt
    for i in range(n):
        pivot = i
        for r in range(i + 1, n):
            if abs(work[r, i]) > abs(work[pivot, i]):
                pivot = r
        for j in range(2 * n + 2):
            swap = work[i, j]
            work[i, j] = work[pivot, j]
            work[pivot, j] = swap
        inverse = 1.0 / work[i, i]
        for j in range(2 * n + 2):
            work[i, j] *= inverse
        for r in range(n):
            factor = work[r, i]
            if r != i and factor != 0.0:
                for j in range(2 * n + 2):
                    work[r, j] -= factor * work[i, j]
    for i in range(n):
        for j in range(n):
            a[i, j] = work[i, n + j]
        b[i] = work[i, 2 * n]
        w[i] = work[i, 2 * n + 1]


@kernel
def discretize(params, v, k, dt, work, a, b, w):
    """Fill the discrete model x' = a x + b u + w for speed v [m/s] and curvature k [1/m]."""
    if params.vehicle_model_type == _KINEMATICS:
        _kinematics(params, v, k, dt, a, b, w)
    elif params.vehicle_model_type == _NO_DELAY:
        _kinematics_no_delay(params, v, k, dt, a, b, w)
    else:
        _dynamics(params, v, k, dt, work, a, b, w)


@kernel
def advance(a, b, w, u, x, out):
    """out = a x + b u + w."""
    for r in range(_STATES):
        total = b[r] * u + w[r]
        for c in range(_STATES):
            total += a[r, c] * x[c]
        out[r] = total


@kernel
def advance_kinematic(a, b, w, u, x0, x1, x2):
    """The same for a kinematic model: a = [[1, *, *], [0, 1, *], [0, 0, *]], w[2] = 0."""
    y0 = x0 + a[0, 1] * x1 + a[0, 2] * x2 + b[0] * u + w[0]
    y1 = x1 + a[1, 2] * x2 + b[1] * u + w[1]
    return y0, y1, a[2, 2] * x2 + b[2] * u


@kernel
def advance_dynamic(a, b, w, u, x0, x1, x2, x3):
    """The same for a model of four states, any of them coupled, held in locals."""
    y0 = a[0, 0] * x0 + a[0, 1] * x1 + a[0, 2] * x2 + a[0, 3] * x3 + b[0] * u + w[0]
    y1 = a[1, 0] * x0 + a[1, 1] * x1 + a[1, 2] * x2 + a[1, 3] * x3 + b[1] * u + w[1]
    y2 = a[2, 0] * x0 + a[2, 1] * x1 + a[2, 2] * x2 + a[2, 3] * x3 + b[2] * u + w[2]
    y3 = a[3, 0] * x0 + a[3, 1] * x1 + a[3, 2] * x2 + a[3, 3] * x3 + b[3] * u + w[3]
    return y0, y1, y2, y3


@kernel
def feed_forward(params, v, k):
    """Steering angle [rad] that holds the curvature k; zero below mpc_zero_ff_steer_deg."""
    if is_kinematic(params):
        steer = atan(params.wheel_base * k)
    else:
        mf, mr = axle_masses(params)
        mass = mf + mr
        lf = params.wheel_base * (1.0 - mf / mass)
        lr = params.wheel_base * (1.0 - mr / mass)
        understeer = lr * mass / (2.0 * params.vehicle_cf * params.wheel_base)
        understeer -= lf * mass / (2.0 * params.vehicle_cr * params.wheel_base)
        steer = params.wheel_base * k + understeer * v * v * k
    return 0.0 if abs(steer) < math.radians(params.mpc_zero_ff_steer_deg) else steer
