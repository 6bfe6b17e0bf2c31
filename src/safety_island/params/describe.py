# SPDX-License-Identifier: Apache-2.0
"""What ``island params show`` prints: each parameter with its value, its range and its origin."""

from __future__ import annotations

from dataclasses import dataclass

from safety_island.params.loader import Loaded
from safety_island.params.scalars import shown
from safety_island.params.schema import KNOWN, values_of


@dataclass(frozen=True)
class Row:
    """One parameter, every column as a text."""

    group: str
    key: str
    kind: str
    unit: str
    allowed: str
    value: str
    origin: str
    doc: str


def describe(loaded: Loaded) -> list[Row]:
    """Return a row for each parameter, in the order of the dataclasses."""
    values = values_of(loaded.parameters)
    return [
        Row(
            group=known.group,
            key=known.key,
            kind=known.kind,
            unit=known.unit,
            allowed=known.range_text,
            value=shown(values[known.key]),
            origin=str(loaded.origins[known.key]),
            doc=known.doc,
        )
        for known in KNOWN.values()
    ]
