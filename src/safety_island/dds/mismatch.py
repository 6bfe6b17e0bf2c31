# SPDX-License-Identifier: Apache-2.0
"""Why two endpoints on one topic do not match: type names, or policies that exclude each other."""

from __future__ import annotations

from safety_island.dds.discovery import RemoteEndpoint
from safety_island.dds.qos import INFINITE_NS, Qos

_STRENGTH = {"best_effort": 0, "reliable": 1, "volatile": 0, "transient_local": 1}
_LIVELINESS = {"automatic": 0, "manual_by_topic": 1}


def incompatible_policies(offered: Qos, requested: Qos) -> list[str]:
    """Name the policies in which a writer offers less than a reader requests; empty when none."""
    found = []
    for name in ("reliability", "durability"):
        have, want = getattr(offered, name), getattr(requested, name)
        if _STRENGTH[have] < _STRENGTH[want]:
            found.append(f"{name} is {have}, requested is {want}")
    if _LIVELINESS[offered.liveliness] < _LIVELINESS[requested.liveliness]:
        found.append(f"liveliness is {offered.liveliness}, requested is {requested.liveliness}")
    for name in ("deadline_ns", "lease_ns"):
        have, want = getattr(offered, name), getattr(requested, name)
        if (have or INFINITE_NS) > (want or INFINITE_NS):
            found.append(f"{name} is {have or 'infinite'}, requested is {want}")
    return found


def why_not(remote: RemoteEndpoint, type_name: str, qos: Qos, *, publisher: bool) -> str | None:
    """Say in one line why a remote endpoint does not match one of ours; None when it does.

    ``publisher`` says that the remote endpoint is the publisher.
    """
    who = "publisher" if publisher else "subscription"
    whom = f"{remote.topic}: {who} {remote.guid.hex()}"
    if remote.type_name != type_name:
        return f"{whom} has type {remote.type_name}, expected {type_name}"
    pair = (remote.qos, qos) if publisher else (qos, remote.qos)
    policies = incompatible_policies(*pair)
    return f"{whom} does not match: {'; '.join(policies)}" if policies else None
