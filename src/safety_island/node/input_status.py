# SPDX-License-Identifier: Apache-2.0
"""The part of the status that tells of the inputs."""

from __future__ import annotations

from collections.abc import Sequence
from struct import Struct
from typing import Any

import numpy as np

from safety_island.kernel.records import Records
from safety_island.messages.fixed import layout
from safety_island.node.input import Input


class InputsStatus:
    """Writes what became of the samples of each input to the (1,) record of a status."""

    def __init__(self, status: Records) -> None:
        fields: Any = status.dtype.fields
        rows, self._start = fields["inputs"][:2]
        self._pack = Struct(f"<{layout(rows)}").pack_into
        self._memory = status.view(np.uint8).data

    def write(self, items: Sequence[Input], ages_s: Sequence[float]) -> None:
        """Write all of them; struct.error for a number that does not fit."""
        self._pack(self._memory, self._start, *input_values(items, ages_s))


def input_values(items: Sequence[Input], ages_s: Sequence[float]) -> list[Any]:
    """Return what became of the samples of each input, with its age, in the order of the message.

    Written out: to get these by a list of their names takes half as long again.
    """
    values: list[Any] = []
    for item, age_s in zip(items, ages_s, strict=True):
        values += (
            item.refusals,
            item.writer_guid,
            item.stamp_ns,
            item.source_ns,
            item.accepted,
            item.subscription.received,
            item.superseded,
            item.refused_in_a_row,
            age_s,
            item.age_limit_s,
            item.stamps.delay_s,
            item.warnings,
            item.last_refusal,
            item.writers.others,
        )
    return values
