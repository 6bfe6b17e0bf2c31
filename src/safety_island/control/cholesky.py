# SPDX-License-Identifier: Apache-2.0
"""Cholesky factor H = R'R (R upper triangular) and the triangular solves that use it.

The inner loops run over slices of contiguous rows and start at zero: in that shape LLVM vectorises
them without reordering a sum. Rows are taken in pairs, so that each earlier row is read once for
two, and four earlier rows at a time, so that the pair is written once for four; an odd order is
rounded up with a row of the identity.
"""

import math

from safety_island.control.status import MpcStatus
from safety_island.kernel.kernel import kernel
from safety_island.kernel.math.exponential import log

NOT_POSITIVE_DEFINITE = int(MpcStatus.NOT_POSITIVE_DEFINITE)
SOLVED = int(MpcStatus.SOLVED)

LOG_MIN_DETERMINANT = -20.72326583694641  # ln(1e-9)
"""The firmware's limit on det H, below which it gives no solution."""


@kernel
def factorize(q, n):
    """Factorize H (n x n) into ``qp_R`` and 1 / diag(R) in ``qp_inverse``.

    Returns SOLVED, or NOT_POSITIVE_DEFINITE for a pivot that is not positive (or NaN) and for
    det H < 1e-9, where the firmware's ``unconstraint_fast`` gives up too.
    """
    if n % 2 == 1:
        _pad(q, n)
    m = n + n % 2
    log_determinant = 0.0
    for half in range(m // 2):
        _reduce_pair(q, 2 * half, m)
        pivots = _scale_pair(q, 2 * half, m)
        if not pivots > 0.0:
            return NOT_POSITIVE_DEFINITE
        log_determinant += log(pivots)
    return SOLVED if log_determinant >= LOG_MIN_DETERMINANT else NOT_POSITIVE_DEFINITE


@kernel
def _pad(q, n):
    """Write row and column n of the identity behind H."""
    for i in range(n):
        q.H[i, n] = 0.0
        q.H[n, i] = 0.0
    q.H[n, n] = 1.0


@kernel
def _reduce_pair(q, k, m):
    """Copy rows k and k + 1 of H and subtract what the rows above contribute."""
    width = m - k
    first = q.qp_R[k][k:m]
    second = q.qp_R[k + 1][k:m]
    first_source = q.H[k][k:m]
    second_source = q.H[k + 1][k:m]
    for i in range(width):
        first[i] = first_source[i]
    for i in range(width):
        second[i] = second_source[i]
    _subtract_fours(q, k, m)
    if k % 4 == 2:
        _subtract_two(q, k, m)


@kernel
def _subtract_fours(q, k, m):
    """Take off what the rows above contribute to rows k and k + 1, by fours as far as that goes."""
    first = q.qp_R[k][k:m]
    second = q.qp_R[k + 1][k:m]
    for quad in range(k // 4):
        a = q.qp_R[4 * quad][k:m]
        b = q.qp_R[4 * quad + 1][k:m]
        c = q.qp_R[4 * quad + 2][k:m]
        d = q.qp_R[4 * quad + 3][k:m]
        a0, b0, c0, d0 = a[0], b[0], c[0], d[0]
        a1, b1, c1, d1 = a[1], b[1], c[1], d[1]
        for i in range(m - k):
            x, y, z, w = a[i], b[i], c[i], d[i]
            first[i] = first[i] - (a0 * x + b0 * y) - (c0 * z + d0 * w)
            second[i] = second[i] - (a1 * x + b1 * y) - (c1 * z + d1 * w)


@kernel
def _subtract_two(q, k, m):
    """Take off what the two rows above contribute to rows k and k + 1."""
    first = q.qp_R[k][k:m]
    second = q.qp_R[k + 1][k:m]
    a = q.qp_R[k - 2][k:m]
    b = q.qp_R[k - 1][k:m]
    a0, b0 = a[0], b[0]
    a1, b1 = a[1], b[1]
    for i in range(m - k):
        x, y = a[i], b[i]
        first[i] -= a0 * x + b0 * y
        second[i] -= a1 * x + b1 * y


@kernel
def _scale_pair(q, k, m):
    """Finish rows k and k + 1; return the product of their pivots, 0 when one is not positive."""
    first = q.qp_R[k][k:m]
    second = q.qp_R[k + 1][k:m]
    pivot = first[0]
    if not pivot > 0.0:
        return 0.0
    inverse = 1.0 / math.sqrt(pivot)
    coupling = first[1] * inverse
    next_pivot = second[1] - coupling * coupling
    if not next_pivot > 0.0:
        return 0.0
    next_inverse = 1.0 / math.sqrt(next_pivot)
    for i in range(m - k):
        value = first[i] * inverse
        first[i] = value
        second[i] = (second[i] - coupling * value) * next_inverse
    q.qp_inverse[k] = inverse
    q.qp_inverse[k + 1] = next_inverse
    return pivot * next_pivot


@kernel
def solve_transposed(q, x, start, n):
    """Solve R'y = x in place; ``x`` is zero before index ``start``."""
    for k in range(start, n):
        width = n - k
        row = q.qp_R[k][k:n]
        rest = x[k:n]
        value = rest[0] * q.qp_inverse[k]
        for i in range(width):
            rest[i] -= value * row[i]
        rest[0] = value


@kernel
def solve_upper(q, x, n):
    """Solve R y = x in place, two rows at a time."""
    even = n - n % 2
    if even < n:
        x[even] *= q.qp_inverse[even]
    for back in range(even // 2):
        k = even - 2 - 2 * back
        above, below = _dot_pair(q.qp_R[k][k + 2 : n], q.qp_R[k + 1][k + 2 : n], x[k + 2 : n])
        x[k + 1] = (x[k + 1] - below) * q.qp_inverse[k + 1]
        x[k] = (x[k] - above - q.qp_R[k, k + 1] * x[k + 1]) * q.qp_inverse[k]


@kernel
def _dot_pair(a, b, x):
    """Scalar products a'x and b'x, each in two interleaved sums."""
    a0 = 0.0
    a1 = 0.0
    b0 = 0.0
    b1 = 0.0
    for half in range(x.size // 2):
        i = 2 * half
        a0 += a[i] * x[i]
        a1 += a[i + 1] * x[i + 1]
        b0 += b[i] * x[i]
        b1 += b[i + 1] * x[i + 1]
    if x.size % 2 == 1:
        i = x.size - 1
        a0 += a[i] * x[i]
        b0 += b[i] * x[i]
    return a0 + a1, b0 + b1


@kernel
def dot(a, b, size):
    """Scalar product of the first ``size`` entries, in four interleaved sums."""
    s0 = 0.0
    s1 = 0.0
    s2 = 0.0
    s3 = 0.0
    for quad in range(size // 4):
        i = 4 * quad
        s0 += a[i] * b[i]
        s1 += a[i + 1] * b[i + 1]
        s2 += a[i + 2] * b[i + 2]
        s3 += a[i + 3] * b[i + 3]
    for i in range(size - size % 4, size):
        s0 += a[i] * b[i]
    return (s0 + s1) + (s2 + s3)


@kernel
def solve_unconstrained(q, n):
    """Set u = -H^-1 f after ``factorize``; v = R^-T f stays in ``qp_v``."""
    for i in range(n):
        q.qp_v[i] = q.f[i]
    solve_transposed(q, q.qp_v, 0, n)
    for i in range(n):
        q.u[i] = -q.qp_v[i]
    solve_upper(q, q.u, n)
