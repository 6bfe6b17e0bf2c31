# SPDX-License-Identifier: Apache-2.0
"""L D L' of the Gram matrix of the working set, kept while rows come and go.

The Gram matrix is M M' with M the rows ``qp_M`` in the order of the working set. Adding a row
appends to L; taking one out is a rank-one update of what stands behind it (Gill, Golub, Murray and
Saunders 1974, method C1), which only ever adds and so stays stable.
"""

from safety_island.control.cholesky import dot
from safety_island.kernel.kernel import kernel


@kernel
def append_row(q, n, k, start):
    """Append the row in slot k of the working set (zero before ``start``) to L and D.

    Returns its squared length; ``qp_D[k]`` against it says how independent the row is.
    """
    new = q.qp_M[q.qp_slot[k]][start:n]
    width = n - start
    row = q.qp_L[k]
    for j in range(k):
        row[j] = dot(q.qp_M[q.qp_slot[j]][start:n], new, width)
    length = dot(new, new, width)
    pivot = length
    for j in range(k):
        value = row[j] - dot(q.qp_L[j], row, j)
        row[j] = value
    for j in range(k):
        value = row[j]
        row[j] = value / q.qp_D[j]
        pivot -= value * row[j]
    row[k] = 1.0
    q.qp_D[k] = pivot
    return length


@kernel
def remove_row(q, k, j):
    """Take row j out of L and D of k rows; ``qp_y`` is left to ``forward``."""
    column = q.qp_target
    for i in range(j + 1, k):
        column[i] = q.qp_L[i, j]
    alpha = q.qp_D[j]
    for t in range(j + 1, k):
        p = column[t]
        old = q.qp_D[t]
        new = old + alpha * p * p
        beta = alpha * p / new if new > 0.0 else 0.0
        alpha = alpha * old / new if new > 0.0 else 0.0
        q.qp_D[t - 1] = new
        for i in range(t + 1, k):
            column[i] -= p * q.qp_L[i, t]
            q.qp_L[i, t] += beta * column[i]
    for t in range(j + 1, k):
        target = q.qp_L[t - 1]
        source = q.qp_L[t]
        for i in range(j):
            target[i] = source[i]
        for i in range(j, t):
            target[i] = source[i + 1]


@kernel
def forward(q, first, k):
    """Set ``qp_y`` = L^-1 excess for the rows from ``first`` to k - 1."""
    for j in range(first, k):
        q.qp_y[j] = q.qp_excess[j] - dot(q.qp_L[j], q.qp_y, j)


@kernel
def solve_targets(q, k):
    """Set ``qp_target`` to the multipliers that make all k rows of the working set tight."""
    target = q.qp_target
    for j in range(k):
        target[j] = q.qp_y[j] / q.qp_D[j]
    back_substitute(q, target, k)


@kernel
def solve_gram(q, x, k):
    """Solve L D L'y = x in place."""
    for j in range(k):
        x[j] -= dot(q.qp_L[j], x, j)
    for j in range(k):
        x[j] /= q.qp_D[j]
    back_substitute(q, x, k)


@kernel
def back_substitute(q, x, k):
    """Solve L'y = x in place."""
    for back in range(k):
        j = k - 1 - back
        row = q.qp_L[j]
        value = x[j]
        for i in range(j):
            x[i] -= value * row[i]
