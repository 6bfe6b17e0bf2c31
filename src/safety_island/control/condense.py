# SPDX-License-Identifier: Apache-2.0
"""The condensed quadratic programme of the MPC: H and f from the models and weights.

The firmware multiplies dense matrices. Here the structure does the work: with the cost to go
``P_j`` (a backward recursion of small matrices) and the response ``Phi_jk B_k`` of state j to input
k, ``H[j, k] = B_j' P_j (Phi_jk B_k)`` for k <= j, which is O(N^2) instead of O(N^3) and equal to
rounding.
"""

from safety_island.control import condense_dynamic, condense_kinematic
from safety_island.control.vehicle_model import is_kinematic
from safety_island.kernel.kernel import kernel

_STATES = 4

_LARGEST = 1e300
"""No sum over a problem whose entries are within this overflows."""


@kernel
def advance(a, b, w, u, x, out):
    """out = a x + b u + w."""
    for r in range(_STATES):
        total = b[r] * u + w[r]
        for c in range(_STATES):
            total += a[r, c] * x[c]
        out[r] = total


@kernel
def _roll_out(lat, n):
    """Fill the response of every step without input."""
    advance(lat.A[0], lat.B[0], lat.W[0], 0.0, lat.x0_delayed, lat.free[0])
    for i in range(1, n):
        advance(lat.A[i], lat.B[i], lat.W[i], 0.0, lat.free[i - 1], lat.free[i])


@kernel
def _add_input_weights(lat, hessian, f, n):
    """Add R1 and R2 to H and the feed-forward's part to f; mirror H."""
    for i in range(n):
        hessian[i, i] += lat.r0[i]
        pull = lat.r0[i] * lat.u_ref[i]
        if i + 1 < n:
            hessian[i + 1, i] += lat.r1[i] - lat.jerk[i]
            hessian[i, i] += lat.jerk[i]
            hessian[i + 1, i + 1] += lat.jerk[i]
            pull += lat.r1[i] * lat.u_ref[i + 1]
        if i + 2 < n:
            hessian[i + 2, i] += lat.r2[i]
            pull += lat.r2[i] * lat.u_ref[i + 2]
        if i > 0:
            pull += lat.r1[i - 1] * lat.u_ref[i - 1]
        if i > 1:
            pull += lat.r2[i - 2] * lat.u_ref[i - 2]
        f[i] -= pull
    for i in range(n):
        for k in range(i):
            hessian[k, i] = hessian[i, k]


@kernel
def is_finite_problem(hessian, f, n):
    """Whether every entry that the solver reads is finite, and their sum too."""
    is_finite = True
    for i in range(n):
        is_finite &= abs(f[i]) <= _LARGEST
        row = hessian[i]
        for k in range(i + 1):
            is_finite &= abs(row[k]) <= _LARGEST
    return is_finite


@kernel
def condense(params, lat, hessian, f, horizon):
    """Fill H and f of ``min 1/2 u'Hu + f'u`` over the steering inputs of the horizon."""
    _roll_out(lat, horizon)
    if is_kinematic(params):
        condense_kinematic.cost_to_go(lat, f, horizon)
        condense_kinematic.fill_hessian(lat, hessian, horizon)
    else:
        condense_dynamic.cost_to_go(lat, f, horizon)
        condense_dynamic.fill_hessian(lat, hessian, horizon)
    _add_input_weights(lat, hessian, f, horizon)
