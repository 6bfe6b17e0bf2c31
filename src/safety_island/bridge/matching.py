"""Which QoS a route takes: what its entry asks for, else what fits every publisher it finds."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Literal, NamedTuple

from safety_island.bridge.config_file import AUTO, QosWish
from safety_island.dds.qos import Durability, Qos, Reliability


class Match(NamedTuple):
    """The policies of both ends of a route, and what a user should know about them."""

    qos: Qos
    warnings: tuple[str, ...] = ()


def match(wish: QosWish, offers: Sequence[Qos]) -> Match:
    """Return the QoS for a route whose publishers offer ``offers`` (none: reliable, volatile).

    Where publishers differ, the weaker policy is taken, which hears all of them. A wish that some
    publisher cannot meet is kept and told: that publisher will not be heard.
    """
    warnings: list[str] = []
    qos = Qos(
        reliability=wish.reliability or _reliability(offers, warnings),
        durability=wish.durability or _durability(offers, warnings),
        depth=wish.depth,
        history=wish.history,
        deadline_ns=_longest(wish.deadline, (offer.deadline_ns for offer in offers)),
        lifespan_ns=_longest(wish.lifespan, (offer.lifespan_ns for offer in offers)),
        liveliness=wish.liveliness or "automatic",
        lease_ns=wish.lease,
    )
    for policy in unheard(qos, offers):
        warnings.append(f"a publisher does not offer the {policy} that the bridge file asks for")
    return Match(qos, tuple(warnings))


def unheard(wanted: Qos, offers: Iterable[Qos]) -> list[str]:
    """Names of the policies for which some publisher offers less than a reader asks for.

    Source: the request-offered rules of DDS 1.4, section 2.2.3.
    """
    found = []
    for offer in offers:
        if wanted.reliability == "reliable" and offer.reliability == "best_effort":
            found.append("reliability 'reliable'")
        if wanted.durability == "transient_local" and offer.durability == "volatile":
            found.append("durability 'transient_local'")
        if wanted.liveliness == "manual_by_topic" and offer.liveliness == "automatic":
            found.append("liveliness 'manual_by_topic'")
        if _shorter(wanted.deadline_ns, offer.deadline_ns):
            found.append("deadline")
        if _shorter(wanted.lease_ns, offer.lease_ns):
            found.append("liveliness_lease_duration")
    return list(dict.fromkeys(found))


def _reliability(offers: Sequence[Qos], warnings: list[str]) -> Reliability:
    found = {offer.reliability for offer in offers}
    if len(found) == 2:
        warnings.append("only some publishers are reliable; taking best_effort to hear all")
    return "best_effort" if "best_effort" in found else "reliable"


def _durability(offers: Sequence[Qos], warnings: list[str]) -> Durability:
    found = {offer.durability for offer in offers}
    if len(found) == 2:
        warnings.append("only some publishers are transient_local; taking volatile to hear all")
    return "transient_local" if found == {"transient_local"} else "volatile"


def _longest(wish: int | Literal["auto"] | None, offers: Iterable[int | None]) -> int | None:
    """The wish, or with AUTO the longest duration on offer; None is infinite."""
    if wish != AUTO:
        return wish
    known = list(offers)
    finite = [offer for offer in known if offer is not None]
    return max(finite) if finite and len(finite) == len(known) else None


def _shorter(wanted: int | None, offered: int | None) -> bool:
    return wanted is not None and (offered is None or offered > wanted)
