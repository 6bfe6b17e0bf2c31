# SPDX-License-Identifier: Apache-2.0
"""The exact optimum of the MPC without bounds, by dynamic programming: O(n), and no matrix H.

The model is x_(j+1) = A x_j + B u_j + W, the cost that of ``cost``. It couples an input with the
two before it, so what is still to be paid after step j is a function of z = (x, u_j, u_(j-1)):

    V(z) = 1/2 z'P z + p'z,   P = 0, p = 0 behind the horizon

From the last step to the first, with Q the weights on x_(j+1), added to P there, and after
p += P_x W for the drift (P_x: the columns of x; M_xy: the block of rows x and columns y):

    h_uu = B'P_xx B + 2 B'P_xu + P_uu + r0_j          the pivot
    h_ux = (B'P_xx + P_ux) A                          by x_j
    h_ua = B'P_xv + P_uv + r1_j                       by a = u_(j-1)
    h_ub = r2_j                                       by b = u_(j-2)
    h_u  = B'p_x + p_u - pull_j

so u_j = -(h_ux x_j + h_ua a + h_ub b + h_u) / h_uu is the best, and what it leaves is the cost to
go of (x_j, a, b), with h = (h_ux, h_ua, h_ub):

    P <- [A'P_xx A  A'P_xv  0]                        [A'p_x]
         [P_vx A    P_vv    0] - h'h / h_uu,     p <- [p_v  ] - h' h_u / h_uu
         [0         0       0]                        [0    ]

where u and v are the two inputs in z. The pivots are those of H when its steps are eliminated from
the last to the first: all positive if and only if H is positive definite, and their product is its
determinant. (D. P. Bertsekas, "Dynamic Programming and Optimal Control", vol. I, section 4.1, with
the last two inputs as a part of the state.)
"""

from safety_island.control import recursion_dynamic, recursion_kinematic
from safety_island.control.cholesky import LOG_MIN_DETERMINANT
from safety_island.control.vehicle_model import is_kinematic
from safety_island.kernel.kernel import kernel
from safety_island.kernel.math.exponential import log

_LARGEST = 1e150
"""The product of two pivots that are within this does not overflow."""


@kernel
def solve_recursively(params, lat, u, n):
    """Set ``u`` (n,) to the minimiser without bounds; whether there is one that can be relied on.

    False for a pivot that is not positive, huge or NaN, and where the determinant of H is below
    the limit of ``cholesky``.
    """
    if is_kinematic(params):
        is_positive = recursion_kinematic.fill_feedback(lat, n)
    else:
        is_positive = recursion_dynamic.fill_feedback(lat, n)
    if not is_positive or not _has_good_pivots(lat.pivot, n):
        return False
    if is_kinematic(params):
        recursion_kinematic.roll_out(lat, u, n)
    else:
        recursion_dynamic.roll_out(lat, u, n)
    return True


@kernel
def _has_good_pivots(pivot, n):
    """Whether the pivots, all positive, are not too large, and their product is not too small."""
    log_determinant = 0.0
    product = 1.0
    for j in range(n):
        if pivot[j] > _LARGEST:
            return False
        product *= pivot[j]
        if j % 2 == 1 or j == n - 1:
            log_determinant += log(product)
            product = 1.0
    return log_determinant >= LOG_MIN_DETERMINANT
