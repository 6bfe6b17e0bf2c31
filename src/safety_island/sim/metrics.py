# SPDX-License-Identifier: Apache-2.0
"""How well a course was driven: lateral error, speed, stops."""

from __future__ import annotations

from dataclasses import dataclass, field

from safety_island.sim.projection import Place

SETTLING_S = 5.0
"""The lateral error counts from this time after the start on [s]."""

MAX_LATERAL_ERROR = 0.3
"""[m]"""

MIN_SPEED_RATIO = 0.95
"""Of the highest speed that the course asked for so far."""

MAX_STOP_ERROR = 0.5
"""[m]"""


@dataclass
class Metrics:
    """Fed while the vehicle drives on its own; errors in m, speeds in m/s, times in s."""

    started: float | None = None
    lateral_error: float = 0.0
    """Now, positive to the left of the path."""
    max_lateral_error: float = 0.0
    """Largest amount after SETTLING_S."""
    left_most: float = 0.0
    right_most: float = 0.0
    top_speed: float = 0.0
    top_target: float = 0.0
    stop_errors: list[float] = field(default_factory=list)
    """Of every stop made, positive beyond it."""

    def update(self, now: float, place: Place, speed: float) -> None:
        """Take the place and speed at ``now``; the first call is the start."""
        if self.started is None:
            self.started = now
        error = self.lateral_error = place.lateral_error
        if now - self.started >= SETTLING_S:
            self.max_lateral_error = max(self.max_lateral_error, abs(error))
            self.left_most = max(self.left_most, error)
            self.right_most = min(self.right_most, error)
        self.top_speed = max(self.top_speed, abs(speed))
        self.top_target = max(self.top_target, place.speed)

    @property
    def on_course(self) -> bool:
        """Whether the vehicle stayed within MAX_LATERAL_ERROR."""
        return self.started is not None and self.max_lateral_error < MAX_LATERAL_ERROR

    @property
    def reached_speed(self) -> bool:
        """Whether the highest speed came near the highest that was asked for."""
        return self.top_speed >= MIN_SPEED_RATIO * self.top_target > 0.0

    @property
    def stopped_in_place(self) -> bool:
        """Whether every stop so far was made within MAX_STOP_ERROR; False before the first."""
        return bool(self.stop_errors) and all(abs(e) <= MAX_STOP_ERROR for e in self.stop_errors)
