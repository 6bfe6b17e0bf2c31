# SPDX-License-Identifier: Apache-2.0
"""The subscriptions of a route: one for each kind of publisher that it hears."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from safety_island.dds.endpoints import Subscription
from safety_island.dds.qos import Qos
from safety_island.dds.raw_topic import RawSample

Taken = list[tuple[Qos, RawSample]]
"""Samples and notices, each with what the subscription that received it asks for."""


class Inlets:
    """Subscriptions by what they ask for; ``subscribe`` makes one, ``leave`` closes it."""

    def __init__(
        self, subscribe: Callable[[Qos], Subscription], leave: Callable[[Subscription], None]
    ) -> None:
        self._subscribe, self._leave = subscribe, leave
        self._open: dict[Qos, Subscription] = {}

    def take(self) -> Taken:
        """Return everything that has come, of each subscription oldest first."""
        return [(asked, raw) for asked, one in self._open.items() for raw in one.take_raw()]

    def open(self, wanted: Iterable[Qos]) -> tuple[set[Qos], Taken]:
        """Open what is wanted and not there yet.

        Return what was opened, and what came to the others until then: a publisher that is new may
        have been heard there first.
        """
        opened = set(wanted) - set(self._open)
        made = {asked: self._subscribe(asked) for asked in opened}
        taken = self.take() if opened else []
        self._open.update(made)
        return opened, taken

    def close_all_but(self, wanted: Iterable[Qos]) -> None:
        """Close what is not wanted any more."""
        for asked in set(self._open) - set(wanted):
            self._leave(self._open.pop(asked))

    def close(self) -> None:
        """Close all."""
        self.close_all_but(())
