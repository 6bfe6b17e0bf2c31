# SPDX-License-Identifier: Apache-2.0
"""A recorded run fed through the real controller node: messages as bytes, time as recorded."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from safety_island import params
from safety_island.control.follower import TrajectoryFollower
from safety_island.dds import topics
from safety_island.messages import inputs as codec
from safety_island.messages.outputs import Control, decode_control, encode_float32_stamped
from safety_island.messages.trajectory import encode_trajectory
from safety_island.messages.wire import Time
from safety_island.node import ControllerNode
from safety_island.node.memory import MemoryDomain
from safety_island.platform.interfaces import LogConfig, LogLevel
from safety_island.platform.sim import make
from safety_island.replay.check import Table
from safety_island.replay.guard_acts import GUARD_COLUMNS, LIMITS, VERDICT
from safety_island.replay.recording import (
    ACCELERATION,
    CONTRACT_COLUMNS,
    ODOMETRY,
    OPERATION_MODE,
    STEERING,
    Recording,
)

_STOP = 1
_POSE_AND_SPEED = ("x", "y", "z", "qx", "qy", "qz", "qw", "vx", "vy", "wz")


class Replay:
    """The controller node on virtual time, and publishers that play a recording to it."""

    def __init__(self, run: Recording, solver: str | None = None) -> None:
        """``solver`` replaces the one that the run was recorded with.

        Raises ParameterError for parameters of the run that cannot be used.
        """
        changes = run.overrides | ({"qp_solver_type": solver} if solver else {})
        parameters = params.read((), "firmware", changes, name=str(run.path)).parameters
        self.run = run
        self.platform = make(LogConfig(level=LogLevel.NONE))
        domain = MemoryDomain(self.platform.clock)
        self.follower = TrajectoryFollower(parameters)
        self.node = ControllerNode(self.platform, domain, self.follower, parameters)
        self._write = {
            topic.key: domain.publisher(topic.name, topic.type_name, topic.qos).write
            for topic in topics.of_release(
                (*topics.INPUTS, topics.STEERING_OFFSET), parameters.node.autoware_release
            )
        }
        entry = topics.CONTROL
        self._published = domain.subscription(entry.name, entry.type_name, entry.qos)
        # The firmware takes the operation mode as received from the beginning, and nothing else.
        start = float(run.state["t"][0]) - parameters.node.ctrl_period
        key, data = _mode(Time.from_seconds(start), _STOP, True)
        self._write[key](data)
        self.node.tick(start)
        self._published.take_all()

    def tick(self, tick: int) -> Control | None:
        """Deliver the messages of one row and do the tick; the command that was published, if any.

        It is decoded from the bytes on ``control_cmd``: behind the guard, as a vehicle gets it.
        """
        self.node.tick(self.deliver(tick))
        sample = self._published.take_newest()
        return None if sample is None else decode_control(sample.data)

    def deliver(self, tick: int) -> float:
        """Move the clock to a row and deliver its messages; return its time [s]."""
        return self.deliver_messages(tick, messages(self.run, tick))

    def deliver_messages(self, tick: int, found: Iterable[Message]) -> float:
        """Deliver what ``messages`` gave of a row, made before."""
        now = float(self.run.state["t"][tick])
        self.platform.clock.advance_to_ns(round(now * 1e9))
        for key, data in found:
            self._write[key](data)
        return now


Message = tuple[str, bytes]
"""Key of an input in the table of topics, and the bytes of one message."""


def messages(run: Recording, tick: int) -> list[Message]:
    """Return the messages that came before a tick."""
    found = []
    if run.has_new_trajectory(tick):
        stamp = Time.from_seconds(float(run.traj_select[tick, 3]))
        data = encode_trajectory(stamp, "map", run.trajectory(tick), run.first_time(tick))
        found.append(("trajectory", data))
    row = {name: float(column[tick]) for name, column in run.state.items()}
    stamp = Time.from_seconds(row["t"])
    mask = int(run.deliver_mask[tick])
    if mask & ODOMETRY:
        values = {name: row[name] for name in _POSE_AND_SPEED}
        odometry = codec.Odometry(stamp, "map", "base_link", **values, vz=0.0, wx=0.0, wy=0.0)
        found.append(("odometry", codec.encode_odometry(odometry)))
    if mask & STEERING:
        steering = codec.Steering(stamp, row["steer"])
        found.append(("steering", codec.encode_steering(steering)))
    if mask & ACCELERATION:
        acceleration = codec.Acceleration(stamp, "base_link", row["ax"], *(0.0,) * 5)
        found.append(("acceleration", codec.encode_acceleration(acceleration)))
    if run.steering_offset is not None and np.isfinite(offset := run.steering_offset[tick]):
        found.append((topics.STEERING_OFFSET.key, encode_float32_stamped(stamp, float(offset))))
    if mask & OPERATION_MODE:
        found.append(_mode(stamp, int(row["mode"]), bool(row["enabled"])))
    return found


def _mode(stamp: Time, mode: int, enabled: bool) -> Message:
    message = codec.OperationMode(stamp, mode, enabled)
    return "operation_mode", codec.encode_operation_mode(message)


def replay(
    run: Recording,
    solver: str | None = None,
    report: Callable[[int], None] | None = None,
) -> dict[str, Table]:
    """Replay a run; return the contract's columns, is_steer_converged and GUARD_COLUMNS.

    Each has the shape (ticks,). A tick that published nothing holds NaN in the columns of the
    command, as in the recordings. ``report`` is told each tick.
    """
    player = Replay(run, solver)
    columns = {name: np.full(run.ticks, np.nan) for name in (*CONTRACT_COLUMNS, *_NOT_RECORDED)}
    columns["t"][:] = run.state["t"]
    for tick in range(run.ticks):
        command, check = player.tick(tick), player.node.check
        columns["published"][tick] = command is not None
        columns[VERDICT][tick], columns[LIMITS][tick] = check.verdict, check.limits
        if command is not None:
            for name in CONTRACT_COLUMNS[2:]:
                columns[name][tick] = getattr(command, name)
            columns["is_steer_converged"][tick] = player.follower.trace[0].is_steer_converged
        if report is not None:
            report(tick)
    return columns


_NOT_RECORDED = ("is_steer_converged", *GUARD_COLUMNS)
"""Columns of a replay beside those of the contract."""
