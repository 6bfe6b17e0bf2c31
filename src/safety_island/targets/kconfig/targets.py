# SPDX-License-Identifier: Apache-2.0
"""The targets: machines that the island is built for."""

from __future__ import annotations

from typing import NamedTuple

from safety_island.errors import ConfigurationError
from safety_island.words import did_you_mean


class Target(NamedTuple):
    """One row; ``name`` is ``board`` or ``board@revision``, as in Zephyr."""

    name: str
    summary: str

    @property
    def board(self) -> str:
        """The name without the revision of the board."""
        return self.name.partition("@")[0]


TARGETS = (
    Target("fvp_baser_aemv8r_smp", "Arm FVP of the AEMv8-R, as in the Zephyr firmware"),
    Target("s32z270dc2_rtu0_r52@D", "NXP S32Z270 on a Cortex-R52, board revision D"),
    Target("freertos_posix", "the simulator: a Linux process with CAN frames in memory"),
    Target("posix", "a plain Linux machine"),
)

NAMES = tuple(target.name for target in TARGETS)


def find_target(name: str) -> Target:
    """Return the target of that name; an unknown one raises ConfigurationError with the list."""
    for target in TARGETS:
        if target.name == name:
            return target
    hint = did_you_mean(name, NAMES)
    raise ConfigurationError(f"unknown target '{name}', expected one of {', '.join(NAMES)}{hint}")
