# SPDX-License-Identifier: Apache-2.0
"""The state of the island in words, its inputs and its counters, a few times a second."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any

from safety_island.life_cycle.state import State
from safety_island.messages.status_fields import InputStatus, Status
from safety_island.monitor.rates import Period, Rate
from safety_island.node.inputs import INPUTS
from safety_island.status.domain import Domain
from safety_island.status.names import name_of
from safety_island.status.values import status_values
from safety_island.status.why import flows, held_by, is_free, why

BEFORE_S = 1.0
"""Statuses of so long a time [s] before say what comes and goes."""
_OF_A_TICK = (
    "tick",
    "state",
    "reason",
    "subject",
    "longitudinal_state",
    "mpc_status",
    "operation_mode",
    "engaged",
    "armed",
    "degraded",
    "published",
    "output_mode",
    "guard_verdict",
    "guard_limits",
    "controller_limits",
    "stop_dist",
    "lateral_s",
    "longitudinal_s",
    "memory_bytes",
    "commands",
)
"""Values of the status that are shown as they are (``status/values.py`` names them)."""
COUNTERS = {
    "guard_clamped": "commands that the guard clamped",
    "guard_refused": "commands that the guard refused",
    "output_failures": "commands that an output could not take",
    "missed_periods_total": "periods missed",
    "foreign_can_frames": "CAN frames of another sender",
    "other_control_writers": "other publishers of the command",
}
"""Of what was rejected or went wrong, and what each counts."""

NameOf = Callable[[int, bytes], str]
"""Names the publisher of an input, by its place and its GUID."""


class Summary:
    """Turns statuses into what the page says in words."""

    def __init__(self, domain: Domain, publisher: NameOf) -> None:
        self._domain, self._publisher = domain, publisher
        self._before: deque[tuple[float, Status]] = deque()
        self._rates = [Rate() for _ in INPUTS]
        self._period = Period()
        self.period_s: float | None = None

    def add(self, now: float, status: Status) -> None:
        """Take a status that came at ``now`` [s]."""
        self._before.append((now, status))
        while self._before[0][0] < now - BEFORE_S:
            self._before.popleft()
        self.period_s = self._period.next(status.tick, status.stamp.seconds)

    def values(self, now: float) -> dict[str, Any]:
        """Return what to show of the newest status. At least one must have been added."""
        *before, status = (status for _, status in self._before)
        named = status_values(status)
        return {
            "t": round(now, 3),
            "why": why(status, before, self._domain),
            "flows": flows(status),
            "free": is_free([*before, status]),
            "held_by": held_by([*before, status]),
            "period_s": self.period_s,
            **{name: named[name] for name in _OF_A_TICK},
            "counters": {text: named[name] for name, text in COUNTERS.items()},
            "inputs": [
                self._input(status.stamp.seconds, place, item, named["inputs"][INPUTS[place].name])
                for place, item in enumerate(status.inputs)
            ],
        }

    def _input(
        self, stamp_s: float, place: int, item: InputStatus, named: dict[str, Any]
    ) -> dict[str, Any]:
        rate = self._rates[place].next(stamp_s, item.received)
        known = any(item.writer_guid)
        return {
            "name": INPUTS[place].name,
            "topic": INPUTS[place].topic.name,
            "expected_hz": INPUTS[place].topic.rate_hz,
            "rate_hz": None if rate is None else round(rate, 1),
            "publisher": self._publisher(place, item.writer_guid) if known else None,
            **{
                name: named[name]
                for name in (
                    "age_s",
                    "age_limit_s",
                    "received",
                    "superseded",
                    "refused",
                    "refused_in_a_row",
                    "last_refusal",
                    "warnings",
                    "other_writers",
                )
            },
        }


def change_of_state(before: Status | None, status: Status) -> str:
    """Say what changed of the island's state; empty when nothing did."""
    if before is None or before.state == status.state:
        return ""
    return f"{name_of(State, before.state)} → {name_of(State, status.state)}"
