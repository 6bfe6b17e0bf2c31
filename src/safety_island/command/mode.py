# SPDX-License-Identifier: Apache-2.0
"""Output modes: where commands go."""

from __future__ import annotations

from enum import IntEnum


class OutputMode(IntEnum):
    """Where commands go; the number stands in the status frame."""

    DDS_ONLY = 0
    CAN_ONLY = 1
    DDS_AND_CAN = 2

    @property
    def uses_dds(self) -> bool:
        """Whether ``control_cmd`` is published."""
        return self is not OutputMode.CAN_ONLY

    @property
    def uses_can(self) -> bool:
        """Whether the three frames are sent."""
        return self is not OutputMode.DDS_ONLY
