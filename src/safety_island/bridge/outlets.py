# SPDX-License-Identifier: Apache-2.0
"""The publishers of a route in the target domain, and which of them speaks for whom."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from safety_island.bridge.config_file import QosWish
from safety_island.bridge.matching import offer_beyond, room
from safety_island.bridge.outlet import HOLD_S, Counts, Outlet
from safety_island.dds.mismatch import incompatible_policies
from safety_island.dds.participant import Participant
from safety_island.dds.qos import Qos


class Outlets:
    """Publishers on one topic (name, type); one is made when the first sample needs it."""

    def __init__(
        self,
        wish: QosWish,
        target: Participant,
        topic: tuple[str, str],
        counts: Counts,
        on_failure: Callable[[str], None],
    ) -> None:
        self._wish, self._target, self._topic = wish, target, topic
        self._counts, self._on_failure = counts, on_failure
        self._open: list[Outlet] = []

    @property
    def offers(self) -> list[Qos]:
        """What is offered now."""
        return [outlet.qos for outlet in self._open]

    def assign(self, user: int, offers: Sequence[Qos], now: float) -> Outlet:
        """Return the outlet for a publisher, a new one when none fits.

        ``user`` is its number; ``offers`` are its policies, and behind them those of all others
        that could share an outlet with it. An outlet is never made weaker, nor made anew.
        """
        qos = offer_beyond(self._wish, offers)
        own = offer_beyond(self._wish, offers[:1])
        fitting = [outlet for outlet in self._open if _fits(outlet, own)]
        fitting.sort(key=lambda outlet: outlet.qos.reliability == "best_effort")
        outlet = fitting[0] if fitting else self.make(qos, now)
        outlet.users.add(user)
        return outlet

    def make(self, qos: Qos, now: float) -> Outlet:
        """Open an outlet; it holds its samples for a moment when somebody waits for it."""
        name, type_name = self._topic
        waiting = [
            other
            for other in self._target.subscriptions(name)
            if other.type_name == type_name and not incompatible_policies(qos, other.qos)
        ]
        publisher = self._target.publisher(name, type_name, qos)
        ready_at = now + HOLD_S if waiting else now
        limit = room(self._wish, qos)
        outlet = Outlet(publisher, limit, ready_at, self._counts, self._on_failure)
        self._open.append(outlet)
        return outlet

    def tidy(self, now: float, *, keeps_one: bool) -> None:
        """Close what speaks for nobody any more, unless it is the one that is always there."""
        for outlet in list(self._open):
            lasts = keeps_one and len(self._open) == 1 and not (outlet.is_latched and outlet.used)
            if not outlet.users and now >= outlet.ready_at and not lasts:
                self.drop(outlet)

    def drop(self, outlet: Outlet) -> None:
        """Close an outlet."""
        if outlet in self._open:
            self._open.remove(outlet)
            outlet.close()

    def flush(self, now: float) -> None:
        """Publish what was held long enough."""
        for outlet in self._open:
            outlet.flush(now)

    @property
    def are_unsettled(self) -> bool:
        """Whether one of them holds samples, or is to be closed."""
        return any(outlet.holds or not outlet.users for outlet in self._open)

    def is_holding(self, now: float) -> bool:
        """Whether one of them still holds its samples."""
        return any(now < outlet.ready_at for outlet in self._open)

    def close(self) -> None:
        """Close all."""
        while self._open:
            self._open.pop().close()


def _fits(outlet: Outlet, wanted: Qos) -> bool:
    """Whether an outlet can speak for one more publisher."""
    if outlet.is_latched or wanted.durability == "transient_local":
        return outlet.qos == wanted and not outlet.users and not outlet.used
    return outlet.qos.reliability == "reliable" or wanted.reliability == "best_effort"
