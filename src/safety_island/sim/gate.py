# SPDX-License-Identifier: Apache-2.0
"""The command gate between controller and vehicle: brakes when commands stop coming.

It does in one place what Autoware's ``vehicle_cmd_gate`` and the fail-safe chain around it do: in
manual mode, before the first command, and after a silence the vehicle brakes with the steering
held. (Autoware's gate alone passes commands when they arrive and times none out; see
docs/autoware.md.)
"""

from __future__ import annotations

from enum import StrEnum

TIMEOUT_S = 0.5
"""Silence after which the gate brakes [s]."""

BRAKE = -2.4
"""Braking of a moving vehicle [m/s^2]; ``emergency_acceleration`` of Autoware's gate."""

HOLD = -1.5
"""Braking at standstill [m/s^2]; ``stop_hold_acceleration`` of Autoware's gate."""


class GateState(StrEnum):
    """What the gate does."""

    WAITING = "waiting"
    """No command has come yet; the vehicle is held."""
    READY = "ready"
    """Commands come, autonomous mode is not engaged; the vehicle is held."""
    DRIVING = "driving"
    """Commands pass."""
    BRAKING = "braking"
    """Commands stopped coming; the vehicle brakes, the steering is held."""


def next_state(silence_s: float | None, engaged: bool, timeout_s: float = TIMEOUT_S) -> GateState:
    """Return the state after ``silence_s`` [s] without a command (None: none has ever come)."""
    if silence_s is None:
        return GateState.WAITING
    if silence_s > timeout_s:
        return GateState.BRAKING
    return GateState.DRIVING if engaged else GateState.READY


class CommandGate:
    """Passes the newest command [rad, m/s^2] on or brakes; told the time, reads no clock."""

    def __init__(self, timeout_s: float = TIMEOUT_S) -> None:
        self.state = GateState.WAITING
        self.engaged = False
        self.received = 0
        self.silences = 0
        self._timeout_s = timeout_s
        self._last: float | None = None
        self._angle = self._acceleration = 0.0

    def offer(self, now: float, angle: float, acceleration: float) -> None:
        """Take a command that came at ``now`` [s, monotonic]."""
        self._last, self._angle, self._acceleration = now, angle, acceleration
        self.received += 1

    def silence(self, now: float) -> float | None:
        """Time [s] since the last command; None before the first."""
        return None if self._last is None else now - self._last

    def output(self, now: float, speed: float) -> tuple[float, float]:
        """Return the angle [rad] and acceleration [m/s^2] for the vehicle at ``speed`` [m/s]."""
        before, self.state = (
            self.state,
            next_state(self.silence(now), self.engaged, self._timeout_s),
        )
        if self.state is GateState.DRIVING:
            return self._angle, self._acceleration
        if self.state is GateState.BRAKING is not before:
            self.silences += 1
        return self._angle, HOLD if speed == 0.0 else BRAKE
