# SPDX-License-Identifier: Apache-2.0
"""What the kernel of the status makes of a tick."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safety_island.command.encoding import Encoding
from safety_island.command.status_message import TICK, begin_status, write_status
from safety_island.control.records import COMMAND, TRACE
from safety_island.control.status import ControllerLimit
from safety_island.life_cycle.state import State
from safety_island.messages import codec
from safety_island.messages.fixed import FixedMessage
from safety_island.messages.status import NO_VALUE, STATUS, decode_status
from safety_island.messages.wire import Time
from tests.messages.strategies import messages

ERRORS = ("lateral_error", "yaw_error", "residual", "stop_dist", "target_vel")
SAME = (*ERRORS, "solver_status", "solver_iterations", "active_constraints", "mpc_status")
COPIED = dict(zip(SAME, SAME, strict=True)) | {"longitudinal_state": "lon_state"}
"""Field of the status -> field of the trace that it is copied from."""

FLAGS = {
    ControllerLimit.STEERING_ANGLE: "angle_limited",
    ControllerLimit.STEERING_RATE: "rate_limited",
    ControllerLimit.STEERING_HELD: "stopped",
    ControllerLimit.ACCELERATION: "acc_limited",
    ControllerLimit.JERK: "jerk_limited",
    ControllerLimit.COMMAND_DIFFERENCE: "diff_limited",
    ControllerLimit.PITCH: "pitch_limited",
    ControllerLimit.SLOW_START: "slow_start_held",
    ControllerLimit.BRAKE_KEEPING: "brake_keeping",
    ControllerLimit.FAR_FROM_TRAJECTORY: "far_from_trajectory",
    ControllerLimit.STUCK_IN_EMERGENCY: "stuck_in_emergency",
}
COMMANDS = {
    "command_angle": "steering_tire_angle",
    "command_rate": "steering_tire_rotation_rate",
    "command_velocity": "velocity",
    "command_acceleration": "acceleration",
}
"""Field of the status -> field of the command."""


def test_every_limit_has_a_flag() -> None:
    assert set(FLAGS) == set(ControllerLimit)


class Island:
    """The records around one status."""

    def __init__(self) -> None:
        self.message = FixedMessage(STATUS)
        self.status = self.message.body[0]
        begin_status.bind(self.message.body)()
        ticks, traces, commands = np.zeros(1, TICK), np.zeros(1, TRACE), np.zeros(1, COMMAND)
        self.tick, self.trace, self.command = ticks[0], traces[0], commands[0]
        self.write = write_status.bind(ticks, traces, commands, self.message.body)


@pytest.fixture
def island() -> Island:
    return Island()


def test_before_the_first_tick_nothing_is_known(island: Island) -> None:
    island.trace.lateral_error, island.trace.solver_status = 1.0, 3
    assert island.write() == Encoding.DONE
    status = decode_status(island.message.to_bytes())
    assert all(math.isnan(getattr(status, name)) for name in ERRORS)
    assert (status.longitudinal_state, status.mpc_status) == (NO_VALUE, NO_VALUE)
    assert (status.solver_status, status.solver_iterations, status.active_constraints) == (0, 0, 0)


def test_what_the_controllers_did_is_copied(island: Island) -> None:
    island.tick.have_controllers_run = True
    for number, name in enumerate(COPIED.values(), 1):
        island.trace[name] = number
    assert island.write() == Encoding.DONE
    assert [island.status[name] for name in COPIED] == list(range(1, len(COPIED) + 1))


def test_in_a_tick_without_them_it_stays_and_no_limit_acted(island: Island) -> None:
    island.tick.have_controllers_run = island.trace.jerk_limited = True
    island.trace.lateral_error = -2.5
    island.write()
    assert island.status.controller_limits == ControllerLimit.JERK
    island.tick.have_controllers_run, island.trace.lateral_error = False, 7.0
    island.write()
    assert (island.status.lateral_error, island.status.controller_limits) == (-2.5, 0)


@given(st.sets(st.sampled_from(list(FLAGS))))
def test_each_flag_has_its_bit(limits: set[ControllerLimit]) -> None:
    island = Island()
    island.tick.have_controllers_run = True
    for limit in limits:
        island.trace[FLAGS[limit]] = True
    island.write()
    assert island.status.controller_limits == sum(limits)


def test_a_command_that_is_sent_is_told_and_counted(island: Island) -> None:
    for number, name in enumerate(COMMANDS.values(), 1):
        island.command[name] = number / 4
    island.tick.is_sent = True
    for count in (1, 2):
        island.write()
        assert island.status.commands == count
    assert [island.status[name] for name in COMMANDS] == [0.25, 0.5, 0.75, 1.0]
    assert island.status.published
    island.tick.is_sent = False
    island.write()
    assert all(math.isnan(island.status[name]) for name in COMMANDS)
    assert not island.status.published and island.status.commands == 2


def test_missed_periods_add_up(island: Island) -> None:
    for missed, total in ((1, 1), (0, 1), (3, 4)):
        island.status.missed_periods = missed
        island.write()
        assert island.status.missed_periods_total == total


@pytest.mark.parametrize(("found", "told"), [(0, 0), (2, 2), (255, 255), (256, 255), (9999, 255)])
def test_more_other_islands_than_fit_are_as_many_as_fit(
    island: Island, found: int, told: int
) -> None:
    island.tick.other_islands = found
    island.write()
    assert island.status.other_control_writers == told


@pytest.mark.parametrize("state", State)
def test_it_is_armed_when_it_drives_or_stops_a_vehicle(island: Island, state: State) -> None:
    island.status.state = state
    island.write()
    assert bool(island.status.armed) is (state in (State.ACTIVE, State.HOLD, State.STOP))


@pytest.mark.parametrize("time", [Time(0, 0), Time(-5, 999_999_999), Time(2**31 - 1, 1)])
def test_the_stamp_is_the_wall_clock(island: Island, time: Time) -> None:
    island.tick.wall_ns = time.nanoseconds
    assert island.write() == Encoding.DONE
    assert decode_status(island.message.to_bytes()).stamp == time


@pytest.mark.parametrize("wall_ns", [2**31 * 10**9, -(2**31) * 10**9 - 1])
def test_a_wall_clock_that_fits_no_stamp_is_refused(island: Island, wall_ns: int) -> None:
    island.tick.wall_ns = wall_ns
    assert island.write() == Encoding.OUT_OF_RANGE


@settings(max_examples=20)
@given(messages(STATUS))
def test_a_record_that_is_set_field_by_field_has_the_bytes_of_the_codec(message: Any) -> None:
    found = FixedMessage(STATUS)
    _set(found.body[0], message)
    assert found.to_bytes() == codec.encode(STATUS, message)


def _set(record: Any, message: dict[str, Any]) -> None:
    for name, value in message.items():
        if isinstance(value, dict):
            _set(record[name], value)
        elif isinstance(value, list) and isinstance(value[0], dict):
            for row, item in zip(record[name], value, strict=True):
                _set(row, item)
        else:
            record[name] = value
