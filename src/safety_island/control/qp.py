"""The quadratic programme of the MPC: its memory, and the exact solve of it.

    minimise 1/2 u'H u + f'u   subject to   lb <= u <= ub,  lbA_i <= u_i - u_(i-1) <= ubA_i

with u_(-1) = 0, so the first row of the second set bounds u_0 itself. In matrix form the rows are
[I; D] with D the first-difference matrix.
"""

from typing import Any

from safety_island.control.limits import MAX_HORIZON
from safety_island.control.records import record

_N = MAX_HORIZON

QP_COLUMNS: list[Any] = [
    ("H", "f8", (_N, _N)),  # symmetric, both triangles; row and column n are overwritten
    ("f", "f8", (_N,)),
    ("lb", "f8", (_N,)),  # [rad]
    ("ub", "f8", (_N,)),
    ("lbA", "f8", (_N,)),  # [rad] a step
    ("ubA", "f8", (_N,)),
    ("u", "f8", (_N,)),  # the solution [rad]
    ("qp_R", "f8", (_N, _N)),  # Cholesky factor, H = R'R, upper triangular
    ("qp_inverse", "f8", (_N,)),  # 1 / diag(R)
    ("qp_v", "f8", (_N,)),  # R^-T f
]
"""Columns that a state record needs so that it can be given to the solvers."""

QP = record(QP_COLUMNS)
"""A quadratic programme that stands alone (tests, benchmark)."""
