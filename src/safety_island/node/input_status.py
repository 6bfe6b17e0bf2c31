"""The part of the status that tells of one input."""

from __future__ import annotations

from safety_island.messages.status import NO_VALUE, NO_WRITER, StatusWriter
from safety_island.node.inputs import Input

_COUNTS = (
    "accepted", "received", "superseded", "refused_in_a_row", "age", "age_limit",
    "transport_delay", "warnings", "last_refusal", "other_writers",
)  # fmt: skip


class InputStatus:
    """Writes what becomes of an input to its place in the status."""

    def __init__(self, item: Input, writer: StatusWriter, place: int) -> None:
        self._item, self._writer, self._place = item, writer, place
        self._pack = writer.pack_input(place, *_COUNTS)
        self._guid = NO_WRITER
        self._refused = 0

    def fill(self, now: float, warnings: int) -> None:
        """Write age, counts and publisher at ``now`` [s, monotonic]; bits of InputWarning."""
        item = self._item
        last = item.last_refusal
        self._pack(
            item.accepted,
            item.subscription.received,
            item.superseded,
            item.refused_in_a_row,
            now - item.accepted_at,
            item.age_limit_s,
            item.stamps.delay_s,
            warnings,
            NO_VALUE if last is None else last,
            min(item.writers.others, 255),
        )
        if item.writer_guid != self._guid:
            self._guid = item.writer_guid
            self._writer.set_writer(self._place, self._guid)
        if item.refused_count != self._refused:
            self._refused = item.refused_count
            for reason, count in item.refused.items():
                self._writer.inputs[self._place].refused[reason] = count
