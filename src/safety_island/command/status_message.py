# SPDX-License-Identifier: Apache-2.0
"""Kernel: the status of a tick as the bytes of ``safety_island_msgs/msg/Status``.

The record of the message is also the memory of what it tells longer than one tick: the totals, and
what the controllers did when they ran last.
"""

import math

import numpy as np

from safety_island.command.encoding import Encoding
from safety_island.command.stamp import write_stamp
from safety_island.control.records import COMMAND, TRACE
from safety_island.control.status import ControllerLimit
from safety_island.kernel.kernel import entry, kernel
from safety_island.kernel.records import record
from safety_island.life_cycle.state import State
from safety_island.messages.status import NO_VALUE, STATUS_RECORD

STATUS = STATUS_RECORD
"""The message behind its header, as CDR lays it out."""

TICK = record(
    [
        ("wall_ns", "i8"),  # wall clock [ns]
        ("other_islands", "i8"),  # publishers of commands that are not ours
        ("is_sent", "?"),  # a command went out on any output
        ("have_controllers_run", "?"),  # both, to their end
    ]
)
"""What a tick did, where the status tells it in other words."""

SNAPSHOT_LAYOUT = 1
"""Number of the layout of a snapshot: another one with every change of what an island remembers."""

_DONE = int(Encoding.DONE)
_OUT_OF_RANGE = int(Encoding.OUT_OF_RANGE)
_ACTIVE, _HOLD, _STOP = int(State.ACTIVE), int(State.HOLD), int(State.STOP)
_MOST_OTHERS = int(np.iinfo(STATUS["other_control_writers"]).max)

_STEERING_ANGLE = int(ControllerLimit.STEERING_ANGLE)
_STEERING_RATE = int(ControllerLimit.STEERING_RATE)
_STEERING_HELD = int(ControllerLimit.STEERING_HELD)
_ACCELERATION = int(ControllerLimit.ACCELERATION)
_JERK = int(ControllerLimit.JERK)
_COMMAND_DIFFERENCE = int(ControllerLimit.COMMAND_DIFFERENCE)
_PITCH = int(ControllerLimit.PITCH)
_SLOW_START = int(ControllerLimit.SLOW_START)
_BRAKE_KEEPING = int(ControllerLimit.BRAKE_KEEPING)
_FAR_FROM_TRAJECTORY = int(ControllerLimit.FAR_FROM_TRAJECTORY)
_STUCK_IN_EMERGENCY = int(ControllerLimit.STUCK_IN_EMERGENCY)


@kernel
def _limits(trace):
    """Bits of ControllerLimit: what bounded or held the command."""
    return (
        trace.angle_limited * _STEERING_ANGLE
        + trace.rate_limited * _STEERING_RATE
        + trace.stopped * _STEERING_HELD
        + trace.acc_limited * _ACCELERATION
        + trace.jerk_limited * _JERK
        + trace.diff_limited * _COMMAND_DIFFERENCE
        + trace.pitch_limited * _PITCH
        + trace.slow_start_held * _SLOW_START
        + trace.brake_keeping * _BRAKE_KEEPING
        + trace.far_from_trajectory * _FAR_FROM_TRAJECTORY
        + trace.stuck_in_emergency * _STUCK_IN_EMERGENCY
    )


@kernel
def _write_controllers(status, trace, have_run):
    """Tell what the controllers did; when they did not run no limit acted, and the rest stays."""
    if not have_run:
        status.controller_limits = 0
        return
    status.controller_limits = _limits(trace)
    status.lateral_error = trace.lateral_error
    status.yaw_error = trace.yaw_error
    status.residual = trace.residual
    status.stop_dist = trace.stop_dist
    status.target_vel = trace.target_vel
    status.solver_status = trace.solver_status
    status.solver_iterations = trace.solver_iterations
    status.active_constraints = trace.active_constraints
    status.longitudinal_state = trace.lon_state
    status.mpc_status = trace.mpc_status


@kernel
def _write_command(status, command, is_sent):
    """Tell what was sent, NaN when nothing was."""
    status.published = is_sent
    if is_sent:
        status.command_angle = command.steering_tire_angle
        status.command_rate = command.steering_tire_rotation_rate
        status.command_velocity = command.velocity
        status.command_acceleration = command.acceleration
        status.commands += np.uint64(1)
    else:
        status.command_angle = math.nan
        status.command_rate = math.nan
        status.command_velocity = math.nan
        status.command_acceleration = math.nan


@entry(STATUS)
def begin_status(messages):
    """Make the status of an island that has not ticked yet: nothing is known, nothing made up."""
    status = messages[0]
    status.snapshot_layout = SNAPSHOT_LAYOUT
    status.lateral_error = math.nan
    status.yaw_error = math.nan
    status.residual = math.nan
    status.stop_dist = math.nan
    status.target_vel = math.nan
    status.longitudinal_state = NO_VALUE
    status.mpc_status = NO_VALUE
    return _DONE


@entry(TICK, TRACE, COMMAND, STATUS)
def write_status(ticks, traces, commands, messages):
    """Finish the status of a tick; return an Encoding, OUT_OF_RANGE when its stamp does not fit.

    Every field that is told as it is has been set before: all but the stamp, what the controllers
    did, the command, the totals, ``armed`` and the number of other islands.
    """
    tick, status = ticks[0], messages[0]
    _write_controllers(status, traces[0], tick.have_controllers_run)
    _write_command(status, commands[0], tick.is_sent)
    status.missed_periods_total += status.missed_periods
    status.other_control_writers = min(tick.other_islands, _MOST_OTHERS)
    status.armed = status.state == _ACTIVE or status.state == _HOLD or status.state == _STOP
    return _DONE if write_stamp(status.stamp, tick.wall_ns) else _OUT_OF_RANGE
