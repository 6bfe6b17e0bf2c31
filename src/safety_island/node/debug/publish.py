# SPDX-License-Identifier: Apache-2.0
"""Publishes the debug topics after each tick: an observer of the node, made when asked for."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from safety_island.control.status import MpcStatus
from safety_island.dds import topics
from safety_island.dds.topics import TopicEntry
from safety_island.messages.debug import (
    encode_control_horizon,
    encode_diagnostics,
    encode_float32_array_stamped,
)
from safety_island.messages.outputs import encode_float32_stamped
from safety_island.messages.points import POINT
from safety_island.messages.trajectory import encode_trajectory
from safety_island.messages.wire import Time
from safety_island.node.controller import ControllerNode
from safety_island.node.debug.diagnostics import diagnostics
from safety_island.node.debug.follower import ObservedFollower
from safety_island.node.debug.horizon import Horizon
from safety_island.node.debug.lateral import LateralNumbers
from safety_island.node.debug.longitudinal import LongitudinalNumbers
from safety_island.node.input_set import TRAJECTORY
from safety_island.node.outputs import TopicWriter
from safety_island.node.report import TickReport

_FRAME = "map"
"""Of trajectories, where the parameters allow any."""
_NOTHING = np.empty(0, np.float32)


class DebugTopics:
    """Tells Autoware's tools what they look at. Every message of a tick carries one stamp."""

    def __init__(self, node: ControllerNode) -> None:
        """Make the publishers. Raises TypeError when the node's follower is no ObservedFollower."""
        follower = node.follower
        if not isinstance(follower, ObservedFollower):
            raise TypeError(f"the node runs {type(follower).__name__}, expected ObservedFollower")
        self._node, self._follower = node, follower
        self._horizon = Horizon(follower)
        self._lateral = LateralNumbers(follower)
        self._longitudinal = LongitudinalNumbers(follower)
        self._frame = node.parameters.gate.map_frame or _FRAME
        self._write = {entry: self._writer(entry) for entry in topics.DEBUG}

    def _writer(self, entry: TopicEntry) -> Callable[[bytes], bool]:
        named = entry.of_release(self._node.parameters.node.autoware_release)
        return TopicWriter(named, self._node.publisher(named), self._node.logger).write

    def __call__(self, report: TickReport) -> None:
        """Publish what the tick computed; the diagnostics also when it computed nothing."""
        stamp = Time.from_nanoseconds(self._node.clock.wall_ns())
        trace = self._follower.trace[0]
        age_s = report.ages_s[TRAJECTORY]
        found = diagnostics(self._node.parameters, trace, age_s)
        self._write[topics.DIAGNOSTICS](encode_diagnostics(stamp, found))
        if self._node.controllers.have_run:
            self._tell_lateral(stamp, report.now)
            self._tell_longitudinal(stamp)

    def _tell_lateral(self, stamp: Time, now: float) -> None:
        """Publish the MPC's view; an unsolved tick has an empty path and no horizon."""
        path, numbers = np.empty(0, POINT), _NOTHING
        if self._follower.trace[0].mpc_status == MpcStatus.SOLVED:
            command = self._follower.command[0]
            angles, rates = self._horizon.commands()
            path, numbers = self._horizon.predicted(), self._lateral.read(float(angles[0]), now)
            moves = float(command.velocity), float(command.acceleration)
            data = encode_control_horizon(stamp, self._horizon.step_s, angles, rates, *moves)
            self._write[topics.CONTROL_HORIZON](data)
        self._write[topics.PREDICTED_TRAJECTORY](encode_trajectory(stamp, self._frame, path))
        self._write[topics.LATERAL_DIAGNOSTIC](encode_float32_array_stamped(stamp, numbers))
        offset = float(self._follower.lateral.offset)
        self._write[topics.ESTIMATED_OFFSET](encode_float32_stamped(stamp, offset))

    def _tell_longitudinal(self, stamp: Time) -> None:
        numbers = encode_float32_array_stamped(stamp, self._longitudinal.read())
        self._write[topics.LONGITUDINAL_DIAGNOSTIC](numbers)
        slope = np.array([self._follower.longitudinal.slope], np.float32)
        self._write[topics.SLOPE_ANGLE](encode_float32_array_stamped(stamp, slope))
