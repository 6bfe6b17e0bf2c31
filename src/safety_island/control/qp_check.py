# SPDX-License-Identifier: Apache-2.0
"""An independent check of a solution of the quadratic programme, before it is used.

Nothing of the solver's own bookkeeping is read, only the problem and ``u``. A point that keeps all
bounds is the minimiser exactly when its gradient g = H u + f is balanced by multipliers of the
right sign on the bounds that it touches. As each bound acts on one step or on two neighbours, that
is a chain: with box multiplier m_i and rate multiplier r_i, step i needs

    r_i = r_(i+1) - g_i - m_i,   r_n = 0

so the set of possible r_i, an interval, can be passed from the last step to the first. Where it
misses the values that the bounds allow, the gap is the residual of that step. Once the end is
reached multipliers with no more than that residual exist, whichever solver found ``u``.
"""

import math

from safety_island.control.status import MpcStatus
from safety_island.kernel.kernel import kernel

SOLVED = int(MpcStatus.SOLVED)
SOLUTION_NOT_FINITE = int(MpcStatus.SOLUTION_NOT_FINITE)
SOLUTION_VIOLATES = int(MpcStatus.SOLUTION_VIOLATES)
SOLUTION_NOT_OPTIMAL = int(MpcStatus.SOLUTION_NOT_OPTIMAL)

MAX_VIOLATION = 1e-9
"""A bound may be exceeded by this; nearer than this it counts as touched [rad]."""

MAX_RESIDUAL = 1e-8
"""Residual of the optimality conditions over the greatest term of the gradient."""


@kernel
def check_solution(q, n):
    """Check ``u``; set ``qp_violation`` and ``qp_residual`` (infinite when not computed).

    Returns SOLVED, SOLUTION_NOT_FINITE, SOLUTION_VIOLATES or SOLUTION_NOT_OPTIMAL.
    """
    q.qp_violation = math.inf
    q.qp_residual = math.inf
    for i in range(n):
        if not math.isfinite(q.u[i]):
            return SOLUTION_NOT_FINITE
    q.qp_violation = violation(q, n)
    if not q.qp_violation <= MAX_VIOLATION:
        return SOLUTION_VIOLATES
    scale = _gradient(q, n)
    gap = _chain_gap(q, n)
    q.qp_residual = gap if scale == 0.0 else gap / scale
    return SOLVED if q.qp_residual <= MAX_RESIDUAL else SOLUTION_NOT_OPTIMAL


@kernel
def check_unconstrained(q, n):
    """Check ``u`` as the minimiser without bounds, as ``check_solution`` does with them."""
    q.qp_violation = 0.0
    q.qp_residual = math.inf
    for i in range(n):
        if not math.isfinite(q.u[i]):
            return SOLUTION_NOT_FINITE
    scale = _gradient(q, n)
    return SOLVED if is_stationary(q, n, scale) else SOLUTION_NOT_OPTIMAL


@kernel
def is_stationary(q, n, scale):
    """Whether the gradient in ``qp_v`` vanishes beside its terms' greatest magnitude ``scale``.

    Sets ``qp_residual``; NaN in the gradient makes it NaN, and does not vanish.
    """
    gap = 0.0
    for i in range(n):
        gap = greater(gap, abs(q.qp_v[i]))
    q.qp_residual = gap if scale == 0.0 else gap / scale
    return q.qp_residual <= MAX_RESIDUAL


@kernel
def greater(a, b):
    """The greater of two numbers, NaN when one is NaN."""
    return a if a >= b or a != a else b


@kernel
def violation(q, n):
    """Greatest excess over a bound [rad]; NaN when a bound is NaN."""
    worst = 0.0
    before = 0.0
    for i in range(n):
        value = q.u[i]
        change = value - before
        worst = greater(worst, value - q.ub[i])
        worst = greater(worst, q.lb[i] - value)
        worst = greater(worst, change - q.ubA[i])
        worst = greater(worst, q.lbA[i] - change)
        if worst != worst:
            return worst
        before = value
    return worst


@kernel
def _gradient(q, n):
    """Set ``qp_v`` = H u + f; return the greatest magnitude in either term."""
    g = q.qp_v
    for i in range(n):
        g[i] = 0.0
    for half in range(n // 2):
        j = 2 * half
        a = q.H[j]
        b = q.H[j + 1]
        x = q.u[j]
        y = q.u[j + 1]
        for i in range(n):
            g[i] += a[i] * x + b[i] * y
    if n % 2 == 1:
        a = q.H[n - 1]
        x = q.u[n - 1]
        for i in range(n):
            g[i] += a[i] * x
    scale = 0.0
    for i in range(n):
        scale = greater(greater(scale, abs(g[i])), abs(q.f[i]))
        g[i] += q.f[i]
    return scale


@kernel
def _chain_gap(q, n):
    """Greatest residual along the chain of the module's docstring, from the last step to the first.

    NaN in the gradient makes it NaN.
    """
    gap = 0.0
    low = 0.0
    high = 0.0
    for back in range(n):
        i = n - 1 - back
        value = q.u[i]
        change = value - q.u[i - 1] if i > 0 else value
        low -= q.qp_v[i]
        high -= q.qp_v[i]
        if value >= q.ub[i] - MAX_VIOLATION:
            low = -math.inf
        if value <= q.lb[i] + MAX_VIOLATION:
            high = math.inf
        allowed_high = math.inf if change >= q.ubA[i] - MAX_VIOLATION else 0.0
        allowed_low = -math.inf if change <= q.lbA[i] + MAX_VIOLATION else 0.0
        if not low <= allowed_high:
            gap = greater(gap, low - allowed_high)
            low = allowed_high
            high = allowed_high
        elif not high >= allowed_low:
            gap = greater(gap, allowed_low - high)
            low = allowed_low
            high = allowed_low
        else:
            low = max(low, allowed_low)
            high = min(high, allowed_high)
    return gap
