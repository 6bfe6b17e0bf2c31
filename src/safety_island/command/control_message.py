# SPDX-License-Identifier: Apache-2.0
"""Kernel: a command as the bytes of ``autoware_control_msgs/msg/Control``."""

from safety_island.command.encoding import Encoding
from safety_island.command.stamp import write_stamp
from safety_island.control.records import COMMAND
from safety_island.kernel.kernel import entry, kernel
from safety_island.messages.fixed import record_type
from safety_island.messages.outputs import CONTROL as _NAME

CONTROL = record_type(_NAME)
"""The message behind its header, as CDR lays it out; its ``control_time`` fields stay zero."""

_DONE = int(Encoding.DONE)
_OUT_OF_RANGE = int(Encoding.OUT_OF_RANGE)
_FARTHEST_S = float(1 << 32)
"""From here on [s] a time is beyond every stamp, and its nanoseconds soon beyond 64 bits."""


@kernel
def _write_time(time, monotonic_s, wall_offset_ns):
    """Write a time on the monotonic clock [s] as a stamp; False when it does not fit."""
    if not -_FARTHEST_S < monotonic_s < _FARTHEST_S:
        return False
    return write_stamp(time, int(monotonic_s * 1e9) + wall_offset_ns)


@entry(COMMAND, CONTROL, int)
def write_control(commands, messages, wall_offset_ns):
    """Write the message of a command; return an Encoding, OUT_OF_RANGE when a stamp does not fit.

    ``wall_offset_ns`` leads from the monotonic to the wall clock. The lateral part carries the
    stamp of the whole, as the firmware has it. The acceleration is always defined (the firmware
    leaves that flag unset), the jerk never.
    """
    command, control = commands[0], messages[0]
    lateral, longitudinal = control.lateral, control.longitudinal
    if not _write_time(control.stamp, command.stamp, wall_offset_ns):
        return _OUT_OF_RANGE
    if not _write_time(longitudinal.stamp, command.longitudinal_stamp, wall_offset_ns):
        return _OUT_OF_RANGE
    lateral.stamp.sec = control.stamp.sec
    lateral.stamp.nanosec = control.stamp.nanosec
    lateral.steering_tire_angle = command.steering_tire_angle
    lateral.steering_tire_rotation_rate = command.steering_tire_rotation_rate
    lateral.is_defined_steering_tire_rotation_rate = command.is_defined_steering_tire_rotation_rate
    longitudinal.velocity = command.velocity
    longitudinal.acceleration = command.acceleration
    longitudinal.jerk = 0.0
    longitudinal.is_defined_acceleration = True
    longitudinal.is_defined_jerk = False
    return _DONE
