# SPDX-License-Identifier: Apache-2.0
"""The wire layout of a trajectory point is the layout that the kernels read."""

from __future__ import annotations

import numba
import numpy as np

from safety_island.control import records
from safety_island.messages.points import POINT, POINT_HEAD, TIME_SIZE


def test_the_layout_is_that_of_the_kernels_to_the_last_flag() -> None:
    assert POINT == records.POINT
    assert POINT.isalignedstruct == records.POINT.isalignedstruct
    assert numba.from_dtype(POINT) == numba.from_dtype(records.POINT)


def test_a_point_has_88_bytes_and_its_head_80() -> None:
    assert POINT.itemsize == 88
    assert POINT_HEAD.itemsize == 80 == POINT.itemsize - TIME_SIZE
    assert all(POINT.fields[n] == POINT_HEAD.fields[n] for n in POINT_HEAD.names)
    assert POINT.fields["sec"] == (np.dtype("i4"), 80)
    assert POINT.fields["nanosec"] == (np.dtype("u4"), 84)
