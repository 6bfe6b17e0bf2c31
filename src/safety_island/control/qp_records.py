# SPDX-License-Identifier: Apache-2.0
"""Memory of the quadratic programme and of its solvers.

    minimise 1/2 u'H u + f'u   subject to   lb <= u <= ub,  lbA_i <= u_i - u_(i-1) <= ubA_i

with u_(-1) = 0, so the first row of the second set bounds u_0 itself. In matrix form the rows are
[I; D] with D the first-difference matrix. Constraint ``c`` is u_c for c < MAX_HORIZON, and
u_i - u_(i-1) with i = c - MAX_HORIZON from there on.
"""

from typing import Any

from safety_island.control.limits import MAX_HORIZON
from safety_island.kernel.records import record

_N = MAX_HORIZON
_SET = MAX_HORIZON + 1  # at most n independent rows, and one that depends on them

QP_COLUMNS: list[Any] = [
    ("H", "f8", (_N, _N)),  # symmetric, both triangles; for odd n, row and column n are overwritten
    ("f", "f8", (_N,)),
    ("lb", "f8", (_N,)),  # [rad]
    ("ub", "f8", (_N,)),
    ("lbA", "f8", (_N,)),  # [rad] a step
    ("ubA", "f8", (_N,)),
    ("u", "f8", (_N,)),  # the solution [rad]
    ("qp_iterations", "i8"),  # of the last solve_constrained; 0: the unconstrained one was taken
    ("qp_active_count", "i8"),  # constraints that the solution is held at
    ("qp_violation", "f8"),  # check_solution: greatest violation of a bound [rad]
    ("qp_residual", "f8"),  # check_solution: of the optimality conditions, relative
    # work memory
    ("qp_R", "f8", (_N, _N)),  # Cholesky factor, H = R'R, upper triangular
    ("qp_inverse", "f8", (_N,)),  # 1 / diag(R)
    ("qp_v", "f8", (_N,)),  # R^-T f; check_solution: the gradient H u + f
    ("qp_free", "f8", (_N,)),  # the unconstrained minimiser
    ("qp_w", "f8", (_N,)),  # a step of u, through the factor
    ("qp_M", "f8", (_SET, _N)),  # rows R^-T a of the working set, by slot
    ("qp_slot", "i8", (_SET,)),  # position in the working set -> row of qp_M; a permutation
    ("qp_start", "i8", (_SET,)),  # that row of qp_M is zero before this column, by position
    ("qp_active", "i8", (_SET,)),  # working set: constraint number
    ("qp_side", "i8", (_SET,)),  # +1 upper bound, -1 lower bound, 0 both (equality)
    ("qp_in_set", "i8", (2 * _N,)),  # 1 for the constraints of the working set
    ("qp_bound", "f8", (_SET,)),  # what the constraint is held at [rad]
    ("qp_excess", "f8", (_SET,)),  # a'free - bound
    ("qp_multiplier", "f8", (_SET,)),  # negative on a lower bound
    ("qp_target", "f8", (_SET,)),  # multipliers that the present working set asks for
    ("qp_L", "f8", (_SET, _SET)),  # unit lower triangular, M M' = L D L'
    ("qp_D", "f8", (_SET,)),
    ("qp_y", "f8", (_SET,)),  # L^-1 excess
]
"""Columns that a state record needs so that it can be given to the solvers."""

QP = record(QP_COLUMNS)
"""A quadratic programme that stands alone (tests, benchmark, OSQP)."""
