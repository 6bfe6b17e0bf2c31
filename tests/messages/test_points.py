# SPDX-License-Identifier: Apache-2.0
"""The wire layout of a trajectory point is the layout that the kernels read."""

from __future__ import annotations

import numba
import numpy as np

from safety_island.control import records
from safety_island.messages.points import POINT, TIME_SIZE


def test_the_layout_is_that_of_the_kernels_to_the_last_flag() -> None:
    assert POINT == records.POINT
    assert POINT.isalignedstruct == records.POINT.isalignedstruct
    assert numba.from_dtype(POINT) == numba.from_dtype(records.POINT)


def test_a_point_has_88_bytes_and_the_next_time_is_last() -> None:
    assert POINT.itemsize == 88
    assert POINT.itemsize - TIME_SIZE == 80
    assert POINT.fields["sec"] == (np.dtype("i4"), 80)
    assert POINT.fields["nanosec"] == (np.dtype("u4"), 84)
