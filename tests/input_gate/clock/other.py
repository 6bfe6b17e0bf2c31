# SPDX-License-Identifier: Apache-2.0
"""An input beside the one that is looked at, as far as the clock of the sender reads it."""

from __future__ import annotations

import math
from typing import Any

from safety_island.input_gate.sender_clock import SenderClock

NEVER = -math.inf
NOW = 9.0
"""When it is looked at [s], unless a test says another time."""


class Input:
    """One more row of the clock's stamps; a field is set and read by its name."""

    def __init__(self, clock: SenderClock, fallen_s: float = 0.0, limit_s: float = 0.5) -> None:
        self.__dict__["row"] = clock.stamps[clock.add(limit_s)]
        self.row.delay_s, self.heard = fallen_s, True

    def __getattr__(self, name: str) -> Any:
        return getattr(self.row, name).item()

    def __setattr__(self, name: str, value: Any) -> None:
        if name == "heard":
            self.row.held_at = NOW if value else NEVER
        else:
            setattr(self.row, name, value)

    @property
    def fallen(self) -> float:
        """How far its stamps have fallen behind [s]."""
        return float(self.row.delay_s + self.row.forgiven_s)
