# SPDX-License-Identifier: Apache-2.0
"""The guard itself: refuse, clamp or pass one command after the other."""

from __future__ import annotations

from math import atan, inf, isfinite, nan, tan

from safety_island.guard.confine import Bounds, confine, share, within
from safety_island.guard.limit import Limit, Verdict
from safety_island.guard.params import GuardParams
from safety_island.guard.proposal import Decision, Proposal
from safety_island.guard.shortcut import Sent, Shortcut
from safety_island.guard.table import Limits, SpeedTable

FUTURE_TOLERANCE_S = 1e-3
"""A stamp may lie that far in the future: it comes from the same clock, by way of rounding."""

STANDSTILL = 1e-9
"""Square of the speed [m^2/s^2] below which any curvature is no lateral acceleration."""

# Plain numbers: arithmetic with an IntFlag costs as much as all the checks together.
_ANGLE, _RATE, _ROTATION_RATE = int(Limit.ANGLE), int(Limit.RATE), int(Limit.ROTATION_RATE)
_DISTANCE, _VELOCITY = int(Limit.STEERING_DISTANCE), int(Limit.VELOCITY)
_LATERAL, _LATERAL_JERK = int(Limit.LATERAL_ACCELERATION), int(Limit.LATERAL_JERK)
_ACCELERATION, _JERK = int(Limit.ACCELERATION), int(Limit.JERK)
_NOT_FINITE, _STALE, _SEQUENCE = int(Limit.NOT_FINITE), int(Limit.STALE), int(Limit.SEQUENCE)
_PASSED, _CLAMPED, _REFUSED = Verdict
_ANGLES = (_DISTANCE, _LATERAL, _LATERAL_JERK, _RATE, _ANGLE)
_AT_FIRST = (_DISTANCE, _LATERAL, _ANGLE)
_PUSHES = (_JERK, _ACCELERATION, _VELOCITY)


def _all_finite(*values: float) -> bool:
    return all(map(isfinite, values))


class Guard:
    """Stands between the controllers and the outputs and shares no code with what it checks."""

    def __init__(self, limits: GuardParams, wheel_base: float, timeout_s: float) -> None:
        """Take the limits, the wheelbase [m] and the age [s] beyond which a command is stale."""
        self._table = SpeedTable(limits)
        self._fastest, self._rolling = limits.velocity, limits.rolling_speed
        self._shortest, self._longest = limits.shortest_step, limits.longest_step
        self._wheel_base, self._timeout = wheel_base, timeout_s
        self._keeps_all = Shortcut(self._table, self._fastest, wheel_base).keeps_all
        self._sent: Sent | None = None
        self._before: Sent | None = None
        """What ``_sent`` was before the last check."""
        self._sequence: float = -inf

    def check(
        self, proposal: Proposal, speed: float, steering: float, engaged: bool = True
    ) -> Decision:
        """Decide on a command, and remember it when it may be sent.

        ``speed`` [m/s] and ``steering`` [rad] are measured. While nobody follows the commands
        (``engaged`` False) their distance from the measured steering says nothing, and is let be.
        """
        self._before = sent = self._sent
        refusal = self._refusal(proposal, speed, steering)
        if refusal:
            return Decision(_REFUSED, refusal, nan, nan, nan, nan)
        now, _, self._sequence, angle, rotation, velocity, push = proposal
        step, slope = self._step(now), tan(angle)
        if sent is not None and self._keeps_all(proposal, slope, sent, speed, steering, step):
            self._sent = now, angle, slope, push
            # Decision's own constructor takes twice as long
            return tuple.__new__(Decision, (_PASSED, 0, angle, rotation, velocity, push))
        return self._judge(proposal, speed, steering, engaged, step)

    def _judge(
        self, proposal: Proposal, speed: float, steering: float, engaged: bool, step: float
    ) -> Decision:
        """Hold each value against its limits, and move it to where it keeps them."""
        now, _, _, asked_angle, asked_rotation, asked_velocity, asked_push = proposal
        turns_round = speed * asked_velocity < 0.0 and abs(speed) > self._rolling
        speed = abs(speed)
        limits = self._table.at(speed)
        distance = limits[3] if engaged else inf
        bounds = self._angles(limits, speed, steering, distance, step)
        angle, bits = confine(asked_angle, bounds)
        rotation, turned = within(asked_rotation, limits[2], _ROTATION_RATE)
        if bits:
            rotation *= share(asked_angle, angle, steering)
        fastest = self._fastest
        velocity, driven = within(asked_velocity, fastest, _VELOCITY)
        may_drive = speed <= fastest and not turns_round
        push, pushed = confine(asked_push, self._accelerations(limits, may_drive, step))
        self._sent = now, angle, tan(angle), push
        bits |= turned | driven | pushed
        return Decision(_CLAMPED if bits else _PASSED, bits, angle, rotation, velocity, push)

    def take_back(self) -> None:
        """Undo the last check, for its command was not sent; its number stays used."""
        self._sent = self._before

    def forget(self) -> None:
        """Let the next command have no predecessor, as after a silence; its number must rise."""
        self._sent = None

    def _refusal(self, proposal: Proposal, speed: float, steering: float) -> int:
        """Return the bits of what is wrong with a command as a whole."""
        now, stamp, sequence, angle, rotation, velocity, acceleration = proposal
        total = now + stamp + angle + rotation + velocity + acceleration + speed + steering
        # What is not finite spreads to the sum; the sum of large numbers may be so by itself.
        if not isfinite(total) and not _all_finite(*proposal[:2], *proposal[3:], speed, steering):
            return _NOT_FINITE
        bits = 0
        if not -FUTURE_TOLERANCE_S <= now - stamp <= self._timeout:
            bits = _STALE
        if sequence <= self._sequence or (self._sent is not None and now < self._sent[0]):
            bits |= _SEQUENCE
        return bits

    def _step(self, now: float) -> float:
        """Return the time [s] since the last command that its change is measured against.

        A tick after a late one comes early. It counts as a whole step, down to half of one, and
        below that as twice its time: many commands at once gain nothing.
        """
        if self._sent is None:
            return 0.0
        gap = now - self._sent[0]
        if self._shortest <= gap <= self._longest:
            return gap
        return min(max(gap, min(self._shortest, 2.0 * gap)), self._longest)

    def _angles(
        self, limits: Limits, speed: float, steering: float, distance: float, step: float
    ) -> Bounds:
        """Return what the steering angle must keep, the weakest first.

        One wrong measurement must not make the wheel jump, so what depends on measurements gives
        way to the limits of change; nothing leads beyond the largest angle.
        """
        largest, rate, _, _, lateral, jerk, _, _, _, _ = limits
        # tan(angle) for a lateral acceleration of 1 m/s^2: the bicycle model, without slip
        per_lateral = self._wheel_base / max(speed * speed, STANDSTILL)
        steepest = atan(lateral * per_lateral)
        if self._sent is None:
            farthest = (steering + distance, steepest, largest)
            return _AT_FIRST, (steering - distance, -steepest, -largest), farthest
        _, before, slope, _ = self._sent
        rise, turn = jerk * step * per_lateral, rate * step
        lows = (steering - distance, -steepest, atan(slope - rise), before - turn, -largest)
        highs = (steering + distance, steepest, atan(slope + rise), before + turn, largest)
        return _ANGLES, lows, highs

    def _accelerations(self, limits: Limits, may_drive: bool, step: float) -> Bounds:
        """Return what the acceleration must keep, the weakest first.

        A vehicle above the largest speed, or told to go the other way than it rolls, may only slow
        down: until it stands, one that speeds up "backward" would speed up forward.
        Drive may always be dropped at once: the limit of change never lifts a command above zero
        that asks for none, so no clamp makes driving out of braking.
        """
        _, _, _, _, _, _, drive, brake, rise, fall = limits
        lowest, highest = -inf, inf
        if self._sent is not None:
            before = self._sent[3]
            lowest, highest = min(before - fall * step, 0.0), before + rise * step
        lows, highs = (lowest, -brake, -inf), (highest, drive, inf if may_drive else 0.0)
        return _PUSHES, lows, highs
