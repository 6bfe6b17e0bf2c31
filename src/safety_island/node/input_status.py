"""The part of the status that tells of the inputs."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from operator import attrgetter

from safety_island.messages.status import StatusWriter
from safety_island.node.input import Input

FIELDS = {
    "refused": "refusals",
    "writer_guid": "writer_guid",
    "accepted": "accepted",
    "received": "subscription.received",
    "superseded": "superseded",
    "refused_in_a_row": "refused_in_a_row",
    "age": "age_s",
    "age_limit": "age_limit_s",
    "transport_delay": "stamps.delay_s",
    "warnings": "warnings",
    "last_refusal": "last_refusal",
    "other_writers": "writers.others",
}
"""Field of the status, in the order of the message -> attribute of Input."""

_read = attrgetter(*FIELDS.values())


class InputStatus:
    """Writes what becomes of the inputs to their places in the status."""

    def __init__(self, items: Sequence[Input], writer: StatusWriter) -> None:
        self._items, self._pack = items, writer.pack_inputs()

    def fill(self) -> None:
        """Write all of it."""
        self._pack(*chain.from_iterable(map(_read, self._items)))
