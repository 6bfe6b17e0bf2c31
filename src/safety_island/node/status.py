# SPDX-License-Identifier: Apache-2.0
"""What the island tells of itself in every tick: its status, on a topic of its own."""

from __future__ import annotations

from operator import attrgetter
from typing import TYPE_CHECKING

import numpy as np

from safety_island.command.encoding import Encoding
from safety_island.command.status_message import TICK, begin_status, write_status
from safety_island.dds import topics
from safety_island.kernel.records import cells
from safety_island.messages.fixed import FixedMessage
from safety_island.messages.status import STATUS
from safety_island.node.input_status import InputsStatus
from safety_island.node.outputs import TopicWriter
from safety_island.node.report import describe
from safety_island.node.transport import Publisher
from safety_island.params import parameters_hash

if TYPE_CHECKING:
    from safety_island.node.controller import ControllerNode
    from safety_island.node.report import TickReport

_FAILED = attrgetter("failed")


class StatusTopic(TopicWriter):
    """Publishes ``safety_island_msgs/msg/Status``."""

    def __init__(self, node: ControllerNode, publisher: Publisher) -> None:
        super().__init__(topics.STATUS, publisher, node.logger)
        self.memory_bytes = 0
        """Resident set size, as it was looked up last."""
        self._node = node
        self._message = message = FixedMessage(STATUS)
        self._fields, self._inputs = cells(message.body), InputsStatus(message.body)
        begin_status.bind(message.body)()
        self._fields["output_mode"][0] = int(node.mode)
        self._fields["parameters_hash"][0] = parameters_hash(node.parameters)
        tick = np.zeros(1, TICK)
        self._tick = cells(tick)
        records = node.follower.trace, node.sender.record, message.body
        self._finish = write_status.bind(tick, *records)

    def send(self, report: TickReport) -> None:
        """Publish the status after a tick; a failure is no reason to stop."""
        try:
            self._tell(report)
            self._tell_node()
            if self._finish() == Encoding.DONE:
                self.write(self._message.to_bytes())
            else:
                self._logger.error("no status: its stamp fits no message", throttled=True)
        except MemoryError:
            raise
        except Exception as error:  # what is only told must not stop what drives
            self._logger.error("no status: %s", describe(error), throttled=True)

    def _tell(self, report: TickReport) -> None:
        """Set what the report of a tick says."""
        fields, (state, reason, cause) = self._fields, report.life
        self._tick["is_sent"][0] = report.sent
        fields["now"][0] = round(report.now * 1e9)
        fields["tick"][0] = report.number
        fields["tick_time"][0] = report.tick_time_s
        fields["lateral_time"][0] = report.lateral_time_s
        fields["longitudinal_time"][0] = report.longitudinal_time_s
        fields["lateness"][0] = report.lateness_s
        fields["missed_periods"][0] = report.skipped
        fields["state"][0] = state
        fields["reason"][0] = reason
        fields["latched_cause"][0] = cause
        fields["subject"][0] = report.subject

    def _tell_node(self) -> None:
        """Set what the rooms know, and what they count."""
        node, fields, tick = self._node, self._fields, self._tick
        check, overrun, arming = node.check, node.life_cycle.overrun, node.arming
        inputs, mode = node.inputs, node.inputs.operation_mode
        tick["wall_ns"][0] = node.clock.wall_ns()
        tick["other_islands"][0] = node.identity.islands.count
        tick["have_controllers_run"][0] = node.controllers.have_run
        fields["arm_nonce"][0] = arming.nonce
        fields["arm_result"][0] = arming.result
        fields["memory"][0] = self.memory_bytes
        fields["foreign_can_frames"][0] = node.sender.foreign_frames
        fields["output_failures"][0] = sum(map(_FAILED, node.sender.outputs))
        fields["overruns"][0] = overrun.in_row
        fields["degraded"][0] = overrun.degraded
        fields["guard_verdict"][0] = check.verdict
        fields["guard_limits"][0] = check.limits
        fields["guard_clamped"][0] = check.clamped
        fields["guard_refused"][0] = check.refused
        fields["sequence"][0] = check.sequence
        fields["engaged"][0] = not inputs.disengaged
        fields["operation_mode"][0] = 0 if mode is None else mode.mode
        fields["control_enabled"][0] = mode is not None and mode.is_autoware_control_enabled
        self._inputs.write(inputs.items, inputs.ages_s)
