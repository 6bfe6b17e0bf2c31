# SPDX-License-Identifier: Apache-2.0
"""The part of the status that tells of the inputs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from safety_island.node.input import Input


def input_values(items: Sequence[Input], ages_s: Sequence[float]) -> list[Any]:
    """Return what became of the samples of each input, with its age, in the order of the message.

    Written out: to get these by a list of their names takes half as long again.
    """
    values: list[Any] = []
    for item, age_s in zip(items, ages_s, strict=True):
        values += (
            item.refusals,
            item.writer_guid,
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
