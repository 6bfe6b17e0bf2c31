# SPDX-License-Identifier: Apache-2.0
"""Names of the numbers in a status; a number of a newer island keeps its digits."""

from __future__ import annotations

from collections.abc import Mapping
from enum import IntEnum, IntFlag

from safety_island.guard import EXPLANATIONS, Limit
from safety_island.messages import registry
from safety_island.messages.status import NO_VALUE, STATUS
from safety_island.node.inputs import INPUTS

VERDICTS = {
    number: name.removeprefix("VERDICT_")
    for name, number in registry.struct_of(STATUS).constants.items()
    if name.startswith("VERDICT_")
}
"""What the guard did, by number."""

GUARD_LIMITS: Mapping[Limit, tuple[str, str]] = EXPLANATIONS
"""The guard's limits -> what each means, what to do."""


def name_of(enum: type[IntEnum], number: int) -> str:
    """Return the name of a number, its digits when it has none."""
    try:
        return enum(number).name
    except ValueError:
        return str(number)


def optional_name(enum: type[IntEnum], number: int) -> str | None:
    """Return the name of a number; None where it stands for no value."""
    return None if number == NO_VALUE else name_of(enum, number)


def verdict_of(number: int) -> str | None:
    """Return what the guard did; None: it was not asked."""
    return None if number == NO_VALUE else VERDICTS.get(number, str(number))


def flags_of(enum: type[IntFlag], bits: int) -> list[str]:
    """Return the names of the bits that are set."""
    return _bit_names({int(flag): str(flag.name) for flag in enum}, bits)


def guard_limits_of(bits: int) -> list[str]:
    """Return the names of the guard's limits whose bits are set."""
    return _bit_names({int(flag): str(flag.name) for flag in GUARD_LIMITS}, bits)


def input_name(place: int) -> str | None:
    """Return the name of an input by its place in the status; None when there is none."""
    return INPUTS[place].name if place < len(INPUTS) else None


def _bit_names(names: Mapping[int, str], bits: int) -> list[str]:
    found = [1 << place for place in range(bits.bit_length()) if bits >> place & 1]
    return [names.get(bit, f"bit {bit.bit_length() - 1}") for bit in found]
