# SPDX-License-Identifier: Apache-2.0
"""The QoS of both ends of a route for its publishers: what the entry asks for, else theirs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Literal

from safety_island.bridge.config_file import AUTO, QosWish
from safety_island.dds.mismatch import incompatible_policies
from safety_island.dds.qos import Qos

DEFAULT_DEPTH = 10
"""Samples that a route keeps for a reader that is slow, as in ROS 2."""
NO_OFFER = Qos()
"""What a route offers when it need not wait for a publisher and there is none."""


def request(wish: QosWish, offer: Qos) -> Qos:
    """Return what a subscription asks for to hear a publisher with all that it offers.

    It keeps everything until it is taken: a depth would be shared by all publishers of the topic,
    and one of them could push out what another one said.
    """
    return Qos(
        reliability=wish.reliability or offer.reliability,
        durability=wish.durability or offer.durability,
        history="keep_all",
        deadline_ns=None if wish.deadline == AUTO else wish.deadline,
        liveliness=wish.liveliness or "automatic",
        lease_ns=wish.lease,
    )


def unmet(wish: QosWish, offer: Qos) -> list[str]:
    """Name the policies for which a publisher offers less than the entry asks for."""
    return incompatible_policies(offer, request(wish, offer))


def offer_beyond(wish: QosWish, offers: Sequence[Qos]) -> Qos:
    """Return what is offered in the target domain for publishers of the same durability.

    Reliable when one of them is: that serves readers of both kinds. Never transient local when
    they are not: a late reader would receive what its publisher did not mean to last. The depth of
    what lasts is the publisher's.
    """
    first = offers[0] if offers else NO_OFFER
    durability = wish.durability or first.durability
    is_latched = durability == "transient_local"
    is_reliable = any(offer.reliability == "reliable" for offer in offers or (NO_OFFER,))
    return Qos(
        reliability=wish.reliability or ("reliable" if is_reliable else "best_effort"),
        durability=durability,
        depth=wish.depth or (first.depth if is_latched else DEFAULT_DEPTH),
        history=wish.history or (first.history if is_latched else "keep_last"),
        deadline_ns=_longest(wish.deadline, (offer.deadline_ns for offer in offers)),
        lifespan_ns=_longest(wish.lifespan, (offer.lifespan_ns for offer in offers)),
        liveliness=wish.liveliness or "automatic",
        lease_ns=wish.lease,
    )


def _longest(wish: int | Literal["auto"] | None, offers: Iterable[int | None]) -> int | None:
    """The wish, or with AUTO the longest duration on offer; None is infinite."""
    if wish != AUTO:
        return wish
    known = list(offers)
    finite = [offer for offer in known if offer is not None]
    return max(finite) if finite and len(finite) == len(known) else None


def room(wish: QosWish, offer: Qos) -> int | None:
    """Samples of one publisher that may wait to be forwarded; None is any number."""
    if offer.history == "keep_all":
        return None
    return wish.depth or max(offer.depth, DEFAULT_DEPTH)
