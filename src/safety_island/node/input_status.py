"""The part of the status that tells of one input."""

from __future__ import annotations

from typing import Any

from safety_island.messages.status import NO_WRITER
from safety_island.node.inputs import Input


class InputStatusFiller:
    """Writes what changed of an input into the cells of its place in the status."""

    def __init__(self, item: Input, cells: Any) -> None:
        self._item, self._cells = item, cells
        self._guid = NO_WRITER
        self._refused = 0
        cells.age_limit[0] = item.age_limit_s

    def fill(self, now: float, warnings: int) -> None:
        """Write age, counts and publisher at ``now`` [s, monotonic]; bits of InputWarning."""
        item, cells = self._item, self._cells
        cells.age[0] = now - item.accepted_at
        cells.accepted[0] = item.accepted
        cells.received[0] = item.subscription.received
        cells.superseded[0] = item.superseded
        cells.transport_delay[0] = item.stamps.delay_s
        cells.warnings[0] = warnings
        cells.refused_in_a_row[0] = item.refused_in_a_row
        cells.other_writers[0] = min(item.writers.others, 255)
        if item.writer_guid != self._guid:
            self._guid = item.writer_guid
            cells.writer_guid[:] = self._guid or NO_WRITER
        if item.refused_count != self._refused:
            self._fill_refused()

    def _fill_refused(self) -> None:
        item, cells = self._item, self._cells
        self._refused = item.refused_count
        for reason, count in item.refused.items():
            cells.refused[reason] = count
        if item.last_refusal is not None:
            cells.last_refusal[0] = int(item.last_refusal)
