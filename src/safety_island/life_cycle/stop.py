# SPDX-License-Identifier: Apache-2.0
"""What CAN_ONLY sends in place of the controllers' commands: the last one again, then the ramp."""

from __future__ import annotations

from safety_island.life_cycle.params import LifeCycleParams
from safety_island.life_cycle.ramp import Motion, StopRamp
from safety_island.life_cycle.state import State


class Stop:
    """The commands of HOLD and STOP, tick by tick; ``last_sent`` is the controllers' last one."""

    def __init__(self, params: LifeCycleParams, period_s: float) -> None:
        self.last_sent = Motion(0.0, 0.0, 0.0, 0.0)
        self._params, self._period_s = params, period_s
        self._holds = 0
        self._ramp: StopRamp | None = None

    @property
    def hold_over(self) -> bool:
        """Whether the last command was repeated often enough."""
        return self._holds >= self._params.hold_ticks

    @property
    def ramp_over(self) -> bool:
        """Whether the ramp has come to its end."""
        return self._ramp is not None and self._ramp.is_over

    def enter(self, state: State, speed: float) -> None:
        """Take the state of this tick, and the speed [m/s] that was measured last."""
        if state is State.STOP and self._ramp is None:
            self._ramp = StopRamp(self._params, self.last_sent, speed)
        elif state not in (State.HOLD, State.STOP):
            self._holds, self._ramp = 0, None

    def motion(self, state: State, step_s: float) -> Motion | None:
        """Return the command ``step_s`` [s] after the last, None in a state that has none."""
        if state is State.HOLD:
            self._holds += max(round(step_s / self._period_s), 1)  # ticks that were missed, too
            return self.last_sent._replace(rate=0.0)
        return None if self._ramp is None else self._ramp.step(step_s)
