# SPDX-License-Identifier: Apache-2.0
"""A pytest plugin that counts negative indexes in compiled kernels, and fails the run at any.

``pytest -p tests.targets.aot.negative_indexes``: the kernels of that process are compiled with a
counter at every access to an array. They need a cache of their own, for the counter's place is in
them.
"""

from __future__ import annotations

import ctypes
from typing import Any

import llvmlite.ir as ir
import numba
import numba.np.arrayobj as arrays
import numpy as np
import pytest

FOUND = ctypes.c_int64(0)
USUAL: Any = arrays.fix_integer_index
_WORD = ir.IntType(64)


def counted(context: Any, builder: Any, kind: Any, index: Any, size: Any) -> Any:
    """What Numba makes of an index, and one more in ``FOUND`` when it is negative."""
    if kind.signed:
        value = context.cast(builder, index, kind, numba.types.intp)
        is_negative = builder.icmp_signed("<", value, ir.Constant(_WORD, 0))
        address = ir.Constant(_WORD, ctypes.addressof(FOUND))
        place = builder.inttoptr(address, _WORD.as_pointer())
        with builder.if_then(is_negative, likely=False):
            builder.store(builder.add(builder.load(place), ir.Constant(_WORD, 1)), place)
    return USUAL(context, builder, kind, index, size)


def pytest_configure() -> None:
    """Put the counter in, and see that it counts."""
    arrays.fix_integer_index = counted
    njit: Any = numba.njit
    at = njit(lambda values, i: values[i])
    assert (at(np.arange(3.0), 2), FOUND.value) == (2.0, 0)
    assert (at(np.arange(3.0), -1), FOUND.value) == (2.0, 1)
    FOUND.value = 0


def pytest_sessionfinish(session: pytest.Session) -> None:
    """Say how many there were."""
    print(f"negative indexes: {FOUND.value}")
    if FOUND.value:
        session.exitstatus = pytest.ExitCode.TESTS_FAILED
