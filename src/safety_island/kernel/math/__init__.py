# SPDX-License-Identifier: Apache-2.0
"""The functions of a maths library that kernels need, so that every machine gives the same bits.

Additions, multiplications, divisions and square roots of doubles are rounded in one way everywhere
(IEEE 754). What a C library makes of them is not, so a kernel calls these functions instead. Each
is less than 1 ulp from the exact value for every double (``tests/kernel/math`` measures it),
rounds both signs alike, and has the special values of C99, Annex F; a NaN that is returned is
always the same one. ``math.sqrt``, ``math.floor``, ``math.fabs`` and ``math.copysign`` are exact
and need no double here.
"""
