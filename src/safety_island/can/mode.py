# SPDX-License-Identifier: Apache-2.0
"""Output modes, and which mode and CAN bus each target starts with."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple


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


class TargetOutput(NamedTuple):
    """What a target starts with; ``can`` is a bus as ``--can`` takes it, None: the target has none.

    Configuration symbol and command line change both.
    """

    mode: OutputMode
    can: str | None


TARGET_OUTPUT: dict[str, TargetOutput] = {
    "fvp_baser_aemv8r_smp": TargetOutput(OutputMode.DDS_ONLY, None),
    "s32z270dc2_rtu0_r52@D": TargetOutput(OutputMode.DDS_AND_CAN, "socketcan:can0"),
    "freertos_posix": TargetOutput(OutputMode.DDS_AND_CAN, "mock"),
    "posix": TargetOutput(OutputMode.DDS_ONLY, None),
}
