# SPDX-License-Identifier: Apache-2.0
"""What the demo knows, fed by the JSON lines of its processes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

Event = Mapping[str, Any]

ISLAND, BRIDGE, VEHICLE = "island", "bridge", "main-compute"
SECOND_ISLAND, ARM = "second island", "arm"
"""What a key starts."""
PAGE = "monitor"
"""What serves the page: nothing of the drive depends on it."""

MOST_TRAIL = 4000
"""Places of the vehicle that are kept; beyond that every other one is left out."""


class KeyEvent(NamedTuple):
    """A key that was pressed, or a reaction."""

    time_s: float
    """Of the drive."""
    text: str
    is_reaction: bool = False


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
    page: str = ""
    """Address of the page; empty when there is none."""
    pressed: list[str] = field(default_factory=list)
    """Buttons of the page that were pressed and have not been obeyed yet."""
    messages: list[str] = field(default_factory=list)
    """What the processes logged, newest last."""
    events: list[KeyEvent] = field(default_factory=list)
    """Keys and reactions."""
    trail: list[tuple[float, float]] = field(default_factory=list)
    """Station and lateral error [m] of where the vehicle was in this lap."""
    has_driven: bool = False
    was_acted_on: bool = False
    """Whether a person disturbed the drive by a key."""
    on_status: list[Callable[[DemoState], None]] = field(default_factory=list, compare=False)
    """Called at each status of the vehicle."""

    def update(self, source: str, event: Event) -> None:
        """Take one event; one that is not known is passed over."""
        kind = event.get("event")
        if source == ISLAND:
            self._update_island(kind, event)
        elif source == VEHICLE:
            if kind == "status":
                self._update_vehicle(event)
            elif kind == "summary":
                self.vehicle_summary = event
        elif source == PAGE:
            self._update_page(kind, event)
        elif kind == "counts":
            self.forwarded = int(event["forwarded"])

    def add_event(self, text: str, *, is_reaction: bool = False) -> None:
        """Note a key or a reaction at this moment of the drive."""
        time_s = float(self.vehicle.get("time_s", 0.0))
        self.events.append(KeyEvent(time_s, text, is_reaction))

    def _update_vehicle(self, event: Event) -> None:
        if event.get("lap") != self.vehicle.get("lap"):
            self.trail.clear()
        self.vehicle = event
        self.has_driven = self.has_driven or self.is_driving
        if self.has_driven:
            self.trail.append((float(event["station"]), float(event["lateral_error"])))
            if len(self.trail) > MOST_TRAIL:
                del self.trail[::2]
        for observer in self.on_status:
            observer(self)

    def _update_island(self, kind: object, event: Event) -> None:
        if kind == "tick":
            self.tick = event
        elif kind == "first_control":
            self.first_control_s = float(event["after_s"])
        elif kind == "summary":
            self.island_summary = event

    def _update_page(self, kind: object, event: Event) -> None:
        if kind == "address":
            self.page = str(event["address"])
            self.messages.append(f"the page: {self.page}")
        elif kind == "press":
            self.pressed.append(str(event["key"]))

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
