"""Entries that solve and check a quadratic programme outside the tick (OSQP, benchmark, tests)."""

from safety_island.control.kernel import entry
from safety_island.control.qp import (
    QP,
    check_solution,
    factorize,
    solve_constrained,
    solve_unconstrained,
)
from safety_island.control.status import MpcStatus

_SOLVED = int(MpcStatus.SOLVED)


@entry(QP, int, int)
def solve_problem(qp, n, max_iterations):
    """Factorize, solve with all constraints and check; returns an MpcStatus."""
    q = qp[0]
    status = factorize(q, n)
    if status == _SOLVED:
        status = solve_constrained(q, n, max_iterations)
    if status == _SOLVED:
        status = check_solution(q, n)
    return status


@entry(QP, int)
def solve_problem_without_limits(qp, n):
    """Factorize and solve without constraints; returns an MpcStatus."""
    q = qp[0]
    status = factorize(q, n)
    if status == _SOLVED:
        solve_unconstrained(q, n)
    return status


@entry(QP, int)
def check_problem(qp, n):
    """Check the solution ``u`` that something else found; returns an MpcStatus."""
    return check_solution(qp[0], n)
