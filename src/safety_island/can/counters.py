# SPDX-License-Identifier: Apache-2.0
"""What CAN output counts."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import Any

from safety_island.can.bus import EventKind
from safety_island.can.command import Cause


@dataclass
class CanCounters:
    """Commands by what became of them, failed frames by identifier and cause, bus events."""

    sent: int = 0
    """Commands whose three frames were handed over."""
    rejected: int = 0
    """Commands of which no frame exists: a value was not finite or out of range."""
    failed: int = 0
    """Commands that lack a frame; none of them was reported as sent."""
    reopened: int = 0
    """Attempts to open the bus again."""
    frames: Counter[tuple[int, Cause]] = field(default_factory=Counter)
    """The first frame that was not sent of each such command, and why."""
    events: Counter[EventKind] = field(default_factory=Counter)

    @property
    def commands(self) -> int:
        """All commands; each has used up a sequence number."""
        return self.sent + self.rejected + self.failed

    def as_dict(self) -> dict[str, Any]:
        """Return everything as plain values, for JSON."""
        return {
            "commands": self.commands,
            "sent": self.sent,
            "rejected": self.rejected,
            "failed": self.failed,
            "reopened": self.reopened,
            "frames": {f"0x{i:03X} {cause}": n for (i, cause), n in sorted(self.frames.items())},
            "events": {str(kind): count for kind, count in sorted(self.events.items())},
        }
