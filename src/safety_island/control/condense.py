# SPDX-License-Identifier: Apache-2.0
"""The condensed quadratic programme of the MPC: H and f from the models and the cost.

The firmware multiplies dense matrices. Here the structure does the work: with the cost to go
``P_j`` (a backward recursion of small matrices) and the response ``Phi_jk B_k`` of state j to input
k, ``H[j, k] = B_j' P_j (Phi_jk B_k)`` for k <= j, which is O(N^2) instead of O(N^3) and equal to
rounding. f is the gradient where every input is zero.
"""

from safety_island.control import condense_dynamic, condense_kinematic
from safety_island.control.gradient import fill_gradient
from safety_island.control.vehicle_model import is_kinematic
from safety_island.kernel.kernel import kernel

_LARGEST = 1e300
"""No sum over a problem whose entries are within this overflows."""


@kernel
def _add_input_weights(lat, hessian, n):
    """Add the three diagonals of the input weights to H; mirror H."""
    for i in range(n):
        hessian[i, i] += lat.r0[i]
    for i in range(1, n):
        hessian[i, i - 1] += lat.r1[i]
    for i in range(2, n):
        hessian[i, i - 2] += lat.r2[i]
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
def condense(params, lat, qp, n):
    """Fill H and f of ``min 1/2 u'Hu + f'u`` over the n inputs of the horizon; u becomes zero.

    Returns whether the problem is finite.
    """
    for i in range(n):
        qp.u[i] = 0.0
    fill_gradient(params, lat, qp.u, n, qp.f)
    if is_kinematic(params):
        condense_kinematic.cost_to_go(lat, n)
        condense_kinematic.fill_hessian(lat, qp.H, n)
    else:
        condense_dynamic.cost_to_go(lat, n)
        condense_dynamic.fill_hessian(lat, qp.H, n)
    _add_input_weights(lat, qp.H, n)
    return is_finite_problem(qp.H, qp.f, n)
