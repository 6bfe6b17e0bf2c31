# SPDX-License-Identifier: Apache-2.0
"""Which output mode and which CAN bus each target starts with."""

from __future__ import annotations

from typing import NamedTuple

from safety_island.command.mode import OutputMode


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
