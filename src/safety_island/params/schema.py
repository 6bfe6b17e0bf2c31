# SPDX-License-Identifier: Apache-2.0
"""Every known key, from the dataclasses: where it lives and what its value may be."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import Field, dataclass, fields
from typing import Any

from safety_island.control.limits import MAX_RATE_TABLE
from safety_island.control.params import (
    LateralParams,
    LongitudinalParams,
    NodeParams,
    Parameters,
    VehicleParams,
    key_of,
)
from safety_island.guard.params import GuardParams
from safety_island.guard.records import MAX_SPEED_POINTS
from safety_island.input_gate.params import GateParams
from safety_island.life_cycle.params import LifeCycleParams


@dataclass(frozen=True)
class IslandParameters(Parameters):
    """One complete set: the controllers' parameters and those of what stands around them."""

    gate: GateParams
    life_cycle: LifeCycleParams
    guard: GuardParams


GROUPS: dict[str, Any] = {
    "vehicle": VehicleParams,
    "node": NodeParams,
    "lateral": LateralParams,
    "longitudinal": LongitudinalParams,
    "gate": GateParams,
    "life_cycle": LifeCycleParams,
    "guard": GuardParams,
}
"""Attribute of ``IslandParameters`` -> its dataclass."""


_LONGEST = {"guard": MAX_SPEED_POINTS}
"""Most entries of a list, where a group's record does not hold MAX_RATE_TABLE of them."""


@dataclass(frozen=True)
class Known:
    """One parameter."""

    key: str
    group: str  # attribute of IslandParameters
    name: str  # attribute of the group
    kind: str  # float, int, bool, str or list (of float)
    unit: str
    doc: str
    low: float
    high: float
    choices: tuple[str, ...]

    @property
    def most_entries(self) -> int:
        """Entries that the record of the kernels holds of a list."""
        return _LONGEST.get(self.group, MAX_RATE_TABLE)

    @property
    def range_text(self) -> str:
        """The values that are allowed, without type and unit."""
        if self.kind == "bool":
            return "true or false"
        if self.kind == "str":
            return ", ".join(self.choices) or "any text"
        return f"{self.low:g} to {self.high:g}"

    @property
    def allowed_text(self) -> str:
        """What a value must be, for the words 'expected ...' of an error."""
        before = {
            "float": "a number from ",
            "int": "a whole number from ",
            "list": f"a list of 1 to {self.most_entries} numbers from ",
            "str": "one of " if self.choices else "",
            "bool": "",
        }
        return before[self.kind] + self.range_text + (f" {self.unit}" if self.unit else "")


def _known(group: str, item: Field[Any]) -> Known:
    meta = item.metadata
    return Known(
        key=key_of(item),
        group=group,
        name=item.name,
        kind="list" if str(item.type).startswith("tuple") else str(item.type),
        unit=meta["unit"],
        doc=meta["doc"],
        low=meta["low"],
        high=meta["high"],
        choices=meta["choices"] or (),
    )


KNOWN: dict[str, Known] = {
    known.key: known
    for known in (_known(group, item) for group, cls in GROUPS.items() for item in fields(cls))
}
"""YAML key -> parameter, in the order of the dataclasses."""


def values_of(parameters: IslandParameters) -> dict[str, Any]:
    """Return every value of a set by its YAML key."""
    return {
        known.key: getattr(getattr(parameters, known.group), known.name) for known in KNOWN.values()
    }


def assemble(values: Mapping[str, Any]) -> IslandParameters:
    """Return the set with these values; every key of KNOWN must be there."""
    groups = {
        group: cls(**{k.name: values[k.key] for k in KNOWN.values() if k.group == group})
        for group, cls in GROUPS.items()
    }
    return IslandParameters(**groups)
