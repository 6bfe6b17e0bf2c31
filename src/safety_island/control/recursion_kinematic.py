# SPDX-License-Identifier: Apache-2.0
"""The recursion of ``recursion`` for the kinematic models, which have three states.

Their matrices are A = [[1, a, b], [0, 1, c], [0, 0, d]] and W = (w0, w1, 0); the yaw error is
state 1. Everything is held in locals: each step waits for the one behind it, and memory would take
its time.
"""

from safety_island.control.vehicle_model import advance_kinematic
from safety_island.kernel.kernel import kernel


@kernel
def fill_feedback(lat, n):
    """Fill ``pivot`` = h_uu and ``feedback`` = (h_u, h_ua, h_ub, h_ux) / h_uu of every step.

    Returns False at a pivot that is not positive.
    """
    # P: the upper triangle of P_xx; P_xu, P_xv; P_uu, P_uv, P_vv; and p
    p00, p01, p02, p11, p12, p22 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    u0, u1, u2, v0, v1, v2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    uu, uv, vv = 0.0, 0.0, 0.0
    g0, g1, g2, gu, gv = 0.0, 0.0, 0.0, 0.0, 0.0
    for j in range(n - 1, -1, -1):
        model, gain, drift = lat.A[j], lat.B[j], lat.W[j]
        a, b, c, d = model[0, 1], model[0, 2], model[1, 2], model[2, 2]
        b0, b1, b2 = gain[0], gain[1], gain[2]
        w0, w1 = drift[0], drift[1]
        p00 += lat.q_lat[j]
        p11 += lat.q_yaw[j]
        g0 += p00 * w0 + p01 * w1
        g1 += p01 * w0 + p11 * w1
        g2 += p02 * w0 + p12 * w1
        gu += u0 * w0 + u1 * w1
        gv += v0 * w0 + v1 * w1
        # h, first by x_(j+1)
        h0 = b0 * p00 + b1 * p01 + b2 * p02 + u0
        h1 = b0 * p01 + b1 * p11 + b2 * p12 + u1
        h2 = b0 * p02 + b1 * p12 + b2 * p22 + u2
        pivot = b0 * (h0 + u0) + b1 * (h1 + u1) + b2 * (h2 + u2) + uu + lat.r0[j]
        hu = b0 * g0 + b1 * g1 + b2 * g2 + gu - lat.pull[j]
        ha = b0 * v0 + b1 * v1 + b2 * v2 + uv + lat.r1[j]
        hb = lat.r2[j]
        h2 = b * h0 + c * h1 + d * h2
        h1 = a * h0 + h1
        if not pivot > 0.0:
            return False
        inverse = 1.0 / pivot
        ku, ka, kb = hu * inverse, ha * inverse, hb * inverse
        k0, k1, k2 = h0 * inverse, h1 * inverse, h2 * inverse
        lat.pivot[j] = pivot
        row = lat.feedback[j]
        row[0], row[1], row[2] = ku, ka, kb
        row[3], row[4], row[5] = k0, k1, k2
        # A'P_xx A, A'P_xv and A'p_x
        m01 = p00 * a + p01
        m02 = p00 * b + p01 * c + p02 * d
        m11 = p01 * a + p11
        m12 = p01 * b + p11 * c + p12 * d
        m22 = p02 * b + p12 * c + p22 * d
        s1 = a * v0 + v1
        s2 = b * v0 + c * v1 + d * v2
        f1 = a * g0 + g1
        f2 = b * g0 + c * g1 + d * g2
        p22 = b * m02 + c * m12 + d * m22 - h2 * k2
        p12 = a * m02 + m12 - h1 * k2
        p11 = a * m01 + m11 - h1 * k1
        p02 = m02 - h0 * k2
        p01 = m01 - h0 * k1
        p00 -= h0 * k0
        u0, u1, u2 = v0 - h0 * ka, s1 - h1 * ka, s2 - h2 * ka
        v0, v1, v2 = -h0 * kb, -h1 * kb, -h2 * kb
        uu, uv, vv = vv - ha * ka, -ha * kb, -hb * kb
        g0, g1, g2 = g0 - h0 * ku, f1 - h1 * ku, f2 - h2 * ku
        gu, gv = gv - ha * ku, -hb * ku
    return True


@kernel
def roll_out(lat, u, n):
    """Fill ``u`` (n,) by the feedback, from the state in which the horizon begins."""
    x0, x1, x2 = lat.x0_delayed[0], lat.x0_delayed[1], lat.x0_delayed[2]
    a, b = 0.0, 0.0
    for j in range(n):
        row = lat.feedback[j]
        known = row[0] + row[1] * a + row[2] * b
        value = -(known + row[3] * x0 + row[4] * x1 + row[5] * x2)
        u[j] = value
        x0, x1, x2 = advance_kinematic(lat.A[j], lat.B[j], lat.W[j], value, x0, x1, x2)
        b = a
        a = value
