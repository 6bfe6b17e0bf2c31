"""The part of the status that tells of one input."""

from __future__ import annotations

from operator import attrgetter

from safety_island.messages.status import NO_WRITER, StatusWriter
from safety_island.node.input import Input

_COUNTS = {
    "accepted": "accepted",
    "received": "subscription.received",
    "superseded": "superseded",
    "refused_in_a_row": "refused_in_a_row",
}
_REST = {
    "age_limit": "age_limit_s",
    "transport_delay": "stamps.delay_s",
    "warnings": "warnings",
    "last_refusal": "last_refusal",
    "other_writers": "writers.others",
}
"""Field of the status -> attribute of Input, before and behind its age."""

_counts, _rest = attrgetter(*_COUNTS.values()), attrgetter(*_REST.values())


class InputStatus:
    """Writes what becomes of an input to its place in the status."""

    def __init__(self, item: Input, writer: StatusWriter, place: int) -> None:
        self._item, self._writer, self._place = item, writer, place
        self._pack = writer.pack_input(place, *_COUNTS, "age", *_REST)
        self._guid = NO_WRITER
        self._refused = 0

    def fill(self, age_s: float) -> None:
        """Write age, counts and publisher."""
        item = self._item
        self._pack(*_counts(item), age_s, *_rest(item))
        if item.writer_guid != self._guid:
            self._guid = item.writer_guid
            self._writer.set_writer(self._place, self._guid)
        if item.refused_count != self._refused:
            self._refused = item.refused_count
            for reason, count in item.refused.items():
                self._writer.inputs[self._place].refused[reason] = count
