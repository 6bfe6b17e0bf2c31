# SPDX-License-Identifier: Apache-2.0
"""The guard itself: refuse, clamp or pass one command after the other.

Plain functions over records (``records.py``), each passed as an array of shape (1,). Every limit is
an interval; ``hold`` moves a value into one after the other, the weakest first. Where the figures
come from stands beside each in ``params/sets/island/guard.param.yaml``: ISO 11270 [1] (lane
keeping), ISO 15622 [2] (adaptive cruise control), Autoware's vehicle_cmd_gate [3].

Where inputs may overflow they are read as ``float(...)``, which as plain Python gives no warning.
"""

import math

from safety_island.guard.limit import Limit, Verdict
from safety_island.kernel.math.inverse import atan
from safety_island.kernel.math.trigonometric import tan

FUTURE_TOLERANCE_S = 1e-3
"""A stamp may lie that far in the future: it comes from the same clock, by way of rounding."""

STANDSTILL = 1e-9
"""Square of the speed [m^2/s^2] below which any curvature is no lateral acceleration."""

_PASSED, _CLAMPED, _REFUSED = (int(verdict) for verdict in Verdict)
_ANGLE, _RATE, _ROTATION_RATE = int(Limit.ANGLE), int(Limit.RATE), int(Limit.ROTATION_RATE)
_DISTANCE, _VELOCITY = int(Limit.STEERING_DISTANCE), int(Limit.VELOCITY)
_LATERAL, _LATERAL_JERK = int(Limit.LATERAL_ACCELERATION), int(Limit.LATERAL_JERK)
_ACCELERATION, _JERK = int(Limit.ACCELERATION), int(Limit.JERK)
_NOT_FINITE, _STALE, _SEQUENCE = int(Limit.NOT_FINITE), int(Limit.STALE), int(Limit.SEQUENCE)


def guard_command(params, state, proposal, decision):
    """Decide on a command, and remember it when it may be sent; return the verdict."""
    limits, memory, asked, answer = params[0], state[0], proposal[0], decision[0]
    copy(memory.sent, memory.before)
    bits = what_is_wrong(limits, memory, asked)
    if bits:
        refuse(answer)
        verdict = _REFUSED
    else:
        bits = clamp(limits, memory.sent, asked, answer)
        remember(memory, asked, answer)
        verdict = _CLAMPED if bits else _PASSED
    answer.verdict, answer.limits = verdict, bits
    return verdict


def what_is_wrong(limits, memory, asked):
    """Return the bits of what is wrong with a command as a whole, for which it is refused."""
    if not is_finite(asked):
        return _NOT_FINITE
    age, bits = float(asked.now) - float(asked.stamp), 0
    if not -FUTURE_TOLERANCE_S <= age <= limits.timeout:
        bits |= _STALE
    is_old = memory.is_numbered and asked.sequence <= memory.sequence
    if is_old or (memory.sent.exists and asked.now < memory.sent.now):
        bits |= _SEQUENCE
    return bits


def clamp(limits, sent, asked, answer):
    """Answer with the nearest values that keep the limits; return the bits of those that acted."""
    angle, steered = hold_angle(limits, sent, asked)
    rate, turned = hold_rate(limits, asked, angle, steered)
    velocity, driven = hold_velocity(limits, asked)
    acceleration, pushed = hold_acceleration(limits, sent, asked)
    answer.steering_tire_angle, answer.steering_tire_rotation_rate = angle, rate
    answer.velocity, answer.acceleration = velocity, acceleration
    return steered | turned | driven | pushed


def hold_angle(limits, sent, asked):
    """Hold the steering angle [rad]; return it and the bits of the limits that acted.

    One wrong measurement must not make the wheel jump, so what depends on measurements gives way to
    the limits of change; nothing leads beyond the largest angle. Lateral acceleration by the
    bicycle model, without slip: speed^2 x tan(angle) / wheelbase.
    """
    speed, steering = abs(float(asked.speed)), asked.steering
    wanted = asked.steering_tire_angle
    angle, bits = wanted, 0
    per_lateral = limits.wheel_base / max(speed * speed, STANDSTILL)  # tan(angle) for 1 m/s^2
    # distance from the measured angle [rad], while the vehicle follows; recorded runs, [3]
    if asked.engaged:
        far = by_speed(limits, limits.steering_distance, speed)
        angle, bits = hold(wanted, angle, bits, steering - far, steering + far, _DISTANCE)
    # lateral acceleration [m/s^2]; [1]
    steepest = atan(by_speed(limits, limits.lateral_acceleration, speed) * per_lateral)
    angle, bits = hold(wanted, angle, bits, -steepest, steepest, _LATERAL)
    if sent.exists:
        step = step_since(limits, sent, asked)
        # lateral jerk [m/s^3]; [1]
        rise = by_speed(limits, limits.lateral_jerk, speed) * step * per_lateral
        low, high = atan(sent.slope - rise), atan(sent.slope + rise)
        angle, bits = hold(wanted, angle, bits, low, high, _LATERAL_JERK)
        # rate of the angle from command to command [rad/s]; the MPC's own, [3]
        turn = by_speed(limits, limits.steering_rate, speed) * step
        angle, bits = hold(wanted, angle, bits, sent.angle - turn, sent.angle + turn, _RATE)
    # largest angle [rad]; the vehicle's own, [3]
    largest = by_speed(limits, limits.steering_angle, speed)
    return hold(wanted, angle, bits, -largest, largest, _ANGLE)


def hold_rate(limits, asked, angle, steered):
    """Hold the steering rate [rad/s] that is sent with the angle; return it and the bits.

    Where the angle was clamped, the tyre takes as long for the rest of its way as it would have
    taken for the whole.
    """
    wanted = asked.steering_tire_rotation_rate
    # rotation rate [rad/s]; recorded runs
    most = by_speed(limits, limits.rotation_rate, abs(asked.speed))
    rate, bits = hold(wanted, wanted, 0, -most, most, _ROTATION_RATE)
    if steered:
        rate *= share(float(asked.steering_tire_angle), angle, float(asked.steering))
    return rate, bits


def hold_velocity(limits, asked):
    """Hold the velocity [m/s]; return it and the bits."""
    wanted = asked.velocity
    # largest speed [m/s]; [3]
    return hold(wanted, wanted, 0, -limits.velocity, limits.velocity, _VELOCITY)


def hold_acceleration(limits, sent, asked):
    """Hold the acceleration [m/s^2]; return it and the bits of the limits that acted.

    A vehicle above the largest speed, or asked to go the other way than it rolls, may only slow
    down: until it is at rest, one that speeds up "backward" would speed up forward.
    Drive may always be dropped at once: the limit of change never lifts a command above zero that
    asks for none, so no clamp makes driving out of braking.
    """
    speed, wanted = abs(asked.speed), asked.acceleration
    acceleration, bits = wanted, 0
    # change of the acceleration [m/s^3]; max_acc_cmd_diff, min_jerk
    if sent.exists:
        step = step_since(limits, sent, asked)
        fall = by_speed(limits, limits.brake_jerk, speed) * step
        lowest = min(sent.acceleration - fall, 0.0)
        highest = sent.acceleration + by_speed(limits, limits.jerk, speed) * step
        acceleration, bits = hold(wanted, acceleration, bits, lowest, highest, _JERK)
    # acceleration that brakes [m/s^2]; [3], and one that drives; [2]
    brake = by_speed(limits, limits.deceleration, speed)
    most = by_speed(limits, limits.acceleration, speed)
    acceleration, bits = hold(wanted, acceleration, bits, -brake, most, _ACCELERATION)
    # largest speed [m/s]; [3], and the one above which a vehicle rolls; noise of the odometry
    turns_round = float(asked.speed) * float(asked.velocity) < 0.0
    if speed > limits.velocity or (turns_round and speed > limits.rolling_speed):
        acceleration, bits = hold(wanted, acceleration, bits, -math.inf, 0.0, _VELOCITY)
    return acceleration, bits


def hold(wanted, kept, bits, low, high, bit):
    """Move the value that earlier limits left into an interval, and add the bit of this one.

    When the intervals have values in common the result is one of them, whatever their order: moving
    a point of one interval to the nearest of another does not leave what they share. When they have
    none in common the last interval holds. A limit acts when it moves the value, or when the value
    as it was wanted breaks it.
    """
    if not low <= wanted <= high or not low <= kept <= high:
        bits |= bit
    return min(max(kept, low), high), bits


def by_speed(limits, values, speed):
    """Return a limit at a speed [m/s]: linear between the points, held outside."""
    points, i = limits.speed_points, 0
    while i < limits.points and points[i] <= speed:
        i += 1
    if i == 0:
        return values[0]
    if i == limits.points:
        return values[i - 1]
    slope = (values[i] - values[i - 1]) / (points[i] - points[i - 1])
    return values[i - 1] + slope * (speed - points[i - 1])


def step_since(limits, sent, asked):
    """Return the time [s] since the last command that a change is measured against.

    A tick after a late one comes early. It counts as a whole step, down to half of one, and below
    that as twice its time: many commands at once gain nothing.
    """
    gap = float(asked.now) - float(sent.now)
    return min(max(gap, min(limits.shortest_step, 2.0 * gap)), limits.longest_step)


def share(wanted, kept, start):
    """Return how much of the way from ``start`` to ``wanted`` is left, 0 to 1, when it ends early.

    A way that turns round, or never was one, is 0; one that became longer is 1.
    """
    whole = wanted - start
    if whole == 0.0:
        return 0.0
    return min(max((kept - start) / whole, 0.0), 1.0)


def is_finite(asked):
    """Whether a command and what was measured are numbers that can be compared."""
    return (
        math.isfinite(asked.now)
        and math.isfinite(asked.stamp)
        and math.isfinite(asked.steering_tire_angle)
        and math.isfinite(asked.steering_tire_rotation_rate)
        and math.isfinite(asked.velocity)
        and math.isfinite(asked.acceleration)
        and math.isfinite(asked.speed)
        and math.isfinite(asked.steering)
    )


def refuse(answer):
    """Answer without values."""
    answer.steering_tire_angle = answer.steering_tire_rotation_rate = math.nan
    answer.velocity = answer.acceleration = math.nan


def remember(memory, asked, answer):
    """Note a command that may be sent."""
    memory.is_numbered, memory.sequence = True, asked.sequence
    memory.sent.exists, memory.sent.now = True, asked.now
    memory.sent.angle = answer.steering_tire_angle
    memory.sent.slope = tan(answer.steering_tire_angle)
    memory.sent.acceleration = answer.acceleration


def guard_take_back(state):
    """Undo the last check, for its command was not sent; its number stays used."""
    copy(state[0].before, state[0].sent)
    return 0


def guard_forget(state):
    """Let the next command have no predecessor, as after a silence; its number must rise."""
    state[0].sent.exists = False
    return 0


def copy(source, target):
    """Copy what is remembered of a command."""
    target.exists, target.now, target.angle = source.exists, source.now, source.angle
    target.slope, target.acceleration = source.slope, source.acceleration
