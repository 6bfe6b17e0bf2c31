# SPDX-License-Identifier: Apache-2.0
"""The gradient of the MPC's cost with respect to its inputs, at any inputs, without a matrix.

Forward, the states x_(i+1) = A_i x_i + B_i u_i + W_i. Back, the adjoint: with Q_i the weights of
step i on the errors among its states,

    lambda_i = Q_i x_(i+1) + A_(i+1)' lambda_(i+1),   lambda_n = 0
    dJ/du_i  = B_i' lambda_i + r0_i u_i + r1_i u_(i-1) + r1_(i+1) u_(i+1)
             + r2_i u_(i-2) + r2_(i+2) u_(i+2) - pull_i

(A. E. Bryson, Y.-C. Ho, "Applied Optimal Control", 1975, section 2.2; ``cost`` has the weights.) It
is H u + f of the condensed problem in O(n), and at u = 0 it is f.
"""

from safety_island.control.qp_check import greater
from safety_island.control.vehicle_model import advance_dynamic, advance_kinematic, is_kinematic
from safety_island.kernel.kernel import kernel


@kernel
def fill_gradient(params, lat, u, n, out):
    """Set ``out`` = dJ/du at ``u`` (n,); return the greatest magnitude of its terms, NaN of NaN."""
    if is_kinematic(params):
        _roll_out_kinematic(lat, u, n)
        _adjoint_kinematic(lat, n, out)
    else:
        _roll_out_dynamic(lat, u, n)
        _adjoint_dynamic(lat, n, out)
    scale = 0.0
    for i in range(n):
        own = lat.r0[i] * u[i]
        scale = greater(greater(scale, abs(out[i])), greater(abs(own), abs(lat.pull[i])))
        out[i] += own - lat.pull[i]
    _add_coupling(lat.r1, u, n, 1, out)
    _add_coupling(lat.r2, u, n, 2, out)
    return scale


@kernel
def _add_coupling(weight, u, n, apart, out):
    """Add what the weights between inputs ``apart`` steps apart contribute."""
    if n <= apart:
        return
    coupling = weight[apart:n]
    before = u[: n - apart]
    behind = u[apart:n]
    first = out[: n - apart]
    second = out[apart:n]
    for i in range(n - apart):
        second[i] += coupling[i] * before[i]
    for i in range(n - apart):
        first[i] += coupling[i] * behind[i]


@kernel
def _roll_out_kinematic(lat, u, n):
    """Fill both errors after every step; the matrices as in ``condense_kinematic``."""
    x0, x1, x2 = lat.x0_delayed[0], lat.x0_delayed[1], lat.x0_delayed[2]
    for i in range(n):
        x0, x1, x2 = advance_kinematic(lat.A[i], lat.B[i], lat.W[i], u[i], x0, x1, x2)
        lat.lateral[i] = x0
        lat.heading[i] = x1


@kernel
def _adjoint_kinematic(lat, n, out):
    g0, g1, g2 = 0.0, 0.0, 0.0
    for i in range(n - 1, -1, -1):
        if i < n - 1:
            model = lat.A[i + 1]
            g2 = model[0, 2] * g0 + model[1, 2] * g1 + model[2, 2] * g2
            g1 += model[0, 1] * g0
        g0 += lat.q_lat[i] * lat.lateral[i]
        g1 += lat.q_yaw[i] * lat.heading[i]
        gain = lat.B[i]
        out[i] = gain[0] * g0 + gain[1] * g1 + gain[2] * g2


@kernel
def _roll_out_dynamic(lat, u, n):
    """Fill both errors after every step of a model whose yaw error is state 2."""
    x = lat.x0_delayed
    x0, x1, x2, x3 = x[0], x[1], x[2], x[3]
    for i in range(n):
        a, b, w = lat.A[i], lat.B[i], lat.W[i]
        x0, x1, x2, x3 = advance_dynamic(a, b, w, u[i], x0, x1, x2, x3)
        lat.lateral[i] = x0
        lat.heading[i] = x2


@kernel
def _adjoint_dynamic(lat, n, out):
    g0, g1, g2, g3 = 0.0, 0.0, 0.0, 0.0
    for i in range(n - 1, -1, -1):
        if i < n - 1:
            a = lat.A[i + 1]
            h0 = a[0, 0] * g0 + a[1, 0] * g1 + a[2, 0] * g2 + a[3, 0] * g3
            h1 = a[0, 1] * g0 + a[1, 1] * g1 + a[2, 1] * g2 + a[3, 1] * g3
            h2 = a[0, 2] * g0 + a[1, 2] * g1 + a[2, 2] * g2 + a[3, 2] * g3
            h3 = a[0, 3] * g0 + a[1, 3] * g1 + a[2, 3] * g2 + a[3, 3] * g3
            g0, g1, g2, g3 = h0, h1, h2, h3
        g0 += lat.q_lat[i] * lat.lateral[i]
        g2 += lat.q_yaw[i] * lat.heading[i]
        b = lat.B[i]
        out[i] = b[0] * g0 + b[1] * g1 + b[2] * g2 + b[3] * g3
