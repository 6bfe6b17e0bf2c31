"""What the demo knows, fed by the JSON lines of its three processes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

Event = Mapping[str, Any]

ISLAND, BRIDGE, VEHICLE = "island", "bridge", "main-compute"


@dataclass
class DemoState:
    """The newest of everything; ``None`` or empty where nothing was reported yet."""

    tick: Event = field(default_factory=dict)
    """Last tick of the island."""
    vehicle: Event = field(default_factory=dict)
    """Last status of the main compute."""
    island_summary: Event = field(default_factory=dict)
    vehicle_summary: Event = field(default_factory=dict)
    forwarded: int = 0
    """Messages that the bridge has passed on."""
    first_control_s: float | None = None
    """From the start of the island's process to its first command."""
    messages: list[str] = field(default_factory=list)
    """What the processes logged, newest last."""

    def update(self, source: str, event: Event) -> None:
        """Take one event; one that is not known is passed over."""
        kind = event.get("event")
        if source == ISLAND:
            self._update_island(kind, event)
        elif source == VEHICLE:
            if kind == "status":
                self.vehicle = event
            elif kind == "summary":
                self.vehicle_summary = event
        elif kind == "counts":
            self.forwarded = int(event["forwarded"])

    def _update_island(self, kind: object, event: Event) -> None:
        if kind == "tick":
            self.tick = event
        elif kind == "first_control":
            self.first_control_s = float(event["after_s"])
        elif kind == "summary":
            self.island_summary = event

    @property
    def is_driving(self) -> bool:
        """Whether the vehicle obeys the island's commands."""
        return self.vehicle.get("gate") == "driving"

    @property
    def oldest_input_s(self) -> float | None:
        """Greatest age of an input that is sent periodically; None when one never came."""
        ages = {k: v for k, v in self.tick.get("ages_s", {}).items() if k != "operation mode"}
        if not ages or any(age is None for age in ages.values()):
            return None
        return float(max(ages.values()))
