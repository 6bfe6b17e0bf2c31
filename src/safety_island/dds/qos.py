# SPDX-License-Identifier: Apache-2.0
"""Quality of service in few words, and the profiles that Autoware uses."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

from cyclonedds.qos import Policy
from cyclonedds.qos import Qos as CycloneQos

Reliability = Literal["reliable", "best_effort"]
Durability = Literal["volatile", "transient_local"]
History = Literal["keep_last", "keep_all"]
Liveliness = Literal["automatic", "manual_by_topic"]

MAX_BLOCKING_NS = 30_000_000
"""Longest time [ns] that a reliable write may wait; it holds up every Python thread."""
INFINITE_NS = 2**63 - 1


@dataclass(frozen=True)
class Qos:
    """Policies of one endpoint; durations in nanoseconds, None is infinite.

    ``depth`` counts samples and matters for ``keep_last`` only.
    """

    reliability: Reliability = "reliable"
    durability: Durability = "volatile"
    depth: int = 1
    history: History = "keep_last"
    deadline_ns: int | None = None
    lifespan_ns: int | None = None
    liveliness: Liveliness = "automatic"
    lease_ns: int | None = None

    def with_depth(self, depth: int) -> Qos:
        """Return the same policies with another history depth."""
        return replace(self, depth=depth)


DEFAULT = Qos()
"""Autoware's usual profile: reliable, volatile, depth 1."""
LATCHED = Qos(durability="transient_local")
"""For states that are sent on change: a late joiner still receives the last one."""
INPUT_DEPTH = 64
"""Samples that a subscription keeps between two ticks, so that what it drops can be counted."""


def cyclone_qos(qos: Qos, user_data: bytes, *, writer: bool, ignore_own: bool = False) -> Any:
    """Return the library's object for an endpoint with these policies."""
    policies: list[Any] = [
        _reliability(qos),
        _durability(qos),
        _history(qos),
        _liveliness(qos),
        Policy.Deadline(_duration(qos.deadline_ns)),
        Policy.DataRepresentation(use_cdrv0_representation=True, use_xcdrv2_representation=False),
        Policy.Userdata(user_data),
    ]
    if writer:
        policies.append(Policy.Lifespan(_duration(qos.lifespan_ns)))
        policies.append(Policy.WriterDataLifecycle(autodispose=False))
        if qos.durability == "transient_local":
            policies.append(Policy.DurabilityService(0, _history(qos), -1, -1, -1))
    elif ignore_own:
        policies.append(Policy.IgnoreLocal.Participant)
    return CycloneQos(*policies)


def from_cyclone(found: Any) -> Qos:
    """Return the policies of a discovered endpoint.

    DDS does not announce the history, except what a transient-local publisher keeps for those who
    come later (``DurabilityService``; its default, and that of peers that say nothing, is 1).
    """
    reliability = found[Policy.Reliability]
    durability = found[Policy.Durability]
    liveliness = found[Policy.Liveliness]
    manual = isinstance(liveliness, Policy.Liveliness.ManualByTopic)
    best_effort = reliability is None or reliability == Policy.Reliability.BestEffort
    volatile = durability is None or durability == Policy.Durability.Volatile
    kept = None if volatile else found[Policy.DurabilityService]
    depth = getattr(getattr(kept, "history", None), "depth", 1)
    keeps_all = kept is not None and kept.history == Policy.History.KeepAll
    return Qos(
        reliability="best_effort" if best_effort else "reliable",
        durability="volatile" if volatile else "transient_local",
        depth=max(depth, 1),
        history="keep_all" if keeps_all else "keep_last",
        deadline_ns=_optional(found[Policy.Deadline], "deadline"),
        lifespan_ns=_optional(found[Policy.Lifespan], "lifespan"),
        liveliness="manual_by_topic" if manual else "automatic",
        lease_ns=_optional(liveliness, "lease_duration"),
    )


def _duration(nanoseconds: int | None) -> int:
    return INFINITE_NS if nanoseconds is None else nanoseconds


def _optional(policy: Any, name: str) -> int | None:
    value = INFINITE_NS if policy is None else int(getattr(policy, name))
    return None if value >= INFINITE_NS else value


def _reliability(qos: Qos) -> Any:
    if qos.reliability == "best_effort":
        return Policy.Reliability.BestEffort
    return Policy.Reliability.Reliable(MAX_BLOCKING_NS)


def _durability(qos: Qos) -> Any:
    names = {"volatile": "Volatile", "transient_local": "TransientLocal"}
    return getattr(Policy.Durability, names[qos.durability])


def _history(qos: Qos) -> Any:
    return (
        Policy.History.KeepAll if qos.history == "keep_all" else Policy.History.KeepLast(qos.depth)
    )


def _liveliness(qos: Qos) -> Any:
    if qos.liveliness == "manual_by_topic":
        return Policy.Liveliness.ManualByTopic(_duration(qos.lease_ns))
    return Policy.Liveliness.Automatic(_duration(qos.lease_ns))
