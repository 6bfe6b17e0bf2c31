# SPDX-License-Identifier: Apache-2.0
"""The processors that kernels are compiled for, and which target has which."""

from __future__ import annotations

import platform
from typing import NamedTuple

from safety_island.targets.errors import BuildError
from safety_island.targets.kconfig.targets import Target


class Machine(NamedTuple):
    """One row; the words of LLVM name triple and cpu."""

    name: str
    triple: str
    cpu: str
    elf_machine: str
    """``e_machine`` of its object files."""
    is_host: bool
    """Whether Python and Linux run on it: it gets a shared library, else a static one."""
    vectorize: bool
    """Whether loops are turned into vector instructions (never across a sum)."""
    is_64_bit: bool = True


X86_64 = Machine(
    "x86_64", "x86_64-unknown-linux-gnu", "x86-64-v2", "EM_X86_64", is_host=True, vectorize=True
)
"""Any x86-64 machine since 2009: SSE4.2 and no more, so the library runs on another one as well."""
AARCH64 = Machine(
    "aarch64", "aarch64-unknown-linux-gnu", "generic", "EM_AARCH64", is_host=True, vectorize=True
)
"""Any 64-bit Arm machine with Linux."""
CORTEX_R82 = Machine(
    "cortex-r82",
    "aarch64-unknown-none-elf",
    "cortex-r82",
    "EM_AARCH64",
    is_host=False,
    vectorize=True,
)
"""ARMv8-R, 64 bits: the processor of the FVP."""
CORTEX_R52 = Machine(
    "cortex-r52",
    "armv8r-unknown-none-eabihf",
    "cortex-r52",
    "EM_ARM",
    is_host=False,
    vectorize=False,  # its vector unit has no double precision and flushes small numbers to zero
    is_64_bit=False,
)
"""ARMv8-R, 32 bits, floating point in registers: the processor of the S32Z."""

HOSTS = {machine.name: machine for machine in (X86_64, AARCH64)}
BOARDS = {"fvp_baser_aemv8r_smp": CORTEX_R82, "s32z270dc2_rtu0_r52": CORTEX_R52}
"""By board; every other target is the machine that builds it."""


def host() -> Machine:
    """Return this machine. Raises BuildError for one that the island is not built on."""
    found = HOSTS.get(platform.machine())
    if found is None:
        known = ", ".join(HOSTS)
        raise BuildError(f"this machine is {platform.machine()}, expected one of {known}")
    return found


def machine_of(target: Target) -> Machine:
    """Return the processor of a target."""
    return BOARDS.get(target.board) or host()
