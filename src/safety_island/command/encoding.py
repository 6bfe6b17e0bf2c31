# SPDX-License-Identifier: Apache-2.0
"""What became of a command on its way to bytes."""

from __future__ import annotations

from enum import IntEnum


class Encoding(IntEnum):
    """Whether its bytes exist, and if not, why."""

    DONE = 0
    NOT_FINITE = 1
    """A value is NaN or infinite."""
    OUT_OF_RANGE = 2
    """A value, or a stamp, is beyond what its field can hold."""
    NOT_USED = 3
    """The output mode uses no CAN."""
