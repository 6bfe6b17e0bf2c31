# SPDX-License-Identifier: Apache-2.0
"""Cost to go and Hessian of the condensed problem for the kinematic models.

Their matrix of a step is upper triangular with two ones, ``[[1, a, b], [0, 1, c], [0, 0, d]]``; the
yaw error is state 1. What is left out would only add zeros, so the numbers are those of
``condense_dynamic``, in a third of the operations. ``condense`` says what is computed here.
"""

from safety_island.kernel.kernel import kernel


@kernel
def cost_to_go(lat, n):
    """Backward recursion: row[j] = B_j' P_j."""
    # the upper triangle of P_j, held in locals: each step waits for the one behind it, and memory
    # would take its time
    p00, p01, p02, p11, p12, p22 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for j in range(n - 1, -1, -1):
        if j < n - 1:
            model = lat.A[j + 1]
            a, b, c, d = model[0, 1], model[0, 2], model[1, 2], model[2, 2]
            w01 = p00 * a + p01
            w02 = p00 * b + p01 * c + p02 * d
            w11 = p01 * a + p11
            w12 = p01 * b + p11 * c + p12 * d
            w22 = p02 * b + p12 * c + p22 * d
            p01 = w01
            p02 = w02
            p11 = a * w01 + w11
            p12 = a * w02 + w12
            p22 = b * w02 + c * w12 + d * w22
        p00 += lat.q_lat[j]
        p11 += lat.q_yaw[j]
        b0, b1, b2 = lat.B[j, 0], lat.B[j, 1], lat.B[j, 2]
        lat.row[j, 0] = b0 * p00 + b1 * p01 + b2 * p02
        lat.row[j, 1] = b0 * p01 + b1 * p11 + b2 * p12
        lat.row[j, 2] = b0 * p02 + b1 * p12 + b2 * p22


@kernel
def fill_hessian(lat, hessian, n):
    """Lower triangle of (CB)'Q(CB), row by row, while the input responses move one step on."""
    z0 = lat.columns[0]
    z1 = lat.columns[1]
    z2 = lat.columns[2]
    for j in range(n):
        model = lat.A[j]
        a, b, c, d = model[0, 1], model[0, 2], model[1, 2], model[2, 2]
        p0, p1, p2 = lat.row[j, 0], lat.row[j, 1], lat.row[j, 2]
        target = hessian[j]
        for k in range(j):
            x1 = z1[k]
            x2 = z2[k]
            y0 = z0[k] + a * x1 + b * x2
            y1 = x1 + c * x2
            y2 = d * x2
            z0[k] = y0
            z1[k] = y1
            z2[k] = y2
            target[k] = p0 * y0 + p1 * y1 + p2 * y2
        b0, b1, b2 = lat.B[j, 0], lat.B[j, 1], lat.B[j, 2]
        z0[j] = b0
        z1[j] = b1
        z2[j] = b2
        target[j] = p0 * b0 + p1 * b1 + p2 * b2
