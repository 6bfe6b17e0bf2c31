# SPDX-License-Identifier: Apache-2.0
"""What the island tells of itself in every tick: its status, on a topic of its own."""

from __future__ import annotations

import math
from operator import attrgetter
from typing import TYPE_CHECKING

from safety_island.dds import topics
from safety_island.input_gate.writers import MOST_OTHERS
from safety_island.kernel.cdr import NANOSECONDS
from safety_island.life_cycle.state import State
from safety_island.messages.status import encode_values
from safety_island.node.input_status import input_values
from safety_island.node.outputs import TopicWriter
from safety_island.node.report import describe
from safety_island.node.trace_status import TraceStatus
from safety_island.node.transport import Publisher

if TYPE_CHECKING:
    from safety_island.node.controller import ControllerNode
    from safety_island.node.report import TickReport

_ARMED = (State.ACTIVE, State.HOLD, State.STOP)
_FAILED = attrgetter("failed")
_NO_COMMAND = (math.nan,) * 4


class StatusTopic(TopicWriter):
    """Publishes ``safety_island_msgs/msg/Status``."""

    def __init__(self, node: ControllerNode, publisher: Publisher) -> None:
        super().__init__(topics.STATUS, publisher, node.logger)
        self.memory_bytes = 0
        """Resident set size, as it was looked up last."""
        self._node, self._mode = node, int(node.mode)
        self._overrun = node.life_cycle.overrun
        self._trace = TraceStatus(node.follower.trace)
        self._commands = self._missed = 0

    def send(self, report: TickReport) -> None:
        """Publish the status after a tick; a failure is no reason to stop."""
        try:
            self._count(report)
            self.write(self._encode(report))
        except MemoryError:
            raise
        except Exception as error:  # what is only told must not stop what drives
            self._logger.error("no status: %s", describe(error), throttled=True)

    def _count(self, report: TickReport) -> None:
        self._commands += report.sent
        self._missed += report.skipped
        if self._node.controllers.have_run:
            self._trace.read()
        else:
            self._trace.clear()

    def _encode(self, report: TickReport) -> bytes:
        """Return the message: all values, in its order."""
        node, command, (state, reason, cause) = self._node, report.command, report.life
        check, overrun, arming, inputs = node.check, self._overrun, node.arming, node.inputs
        mode = inputs.operation_mode
        errors, solver, states, limits = self._trace.last
        sent, others = report.sent, len(node.identity.islands.others)
        return encode_values(
            *divmod(node.clock.wall_ns(), NANOSECONDS),
            arming.nonce,
            report.number,
            self._commands,
            self.memory_bytes,
            node.sender.foreign_frames,
            *errors,
            *(_NO_COMMAND if command is None or not sent else command[2:6]),
            report.tick_time_s,
            report.lateral_time_s,
            report.longitudinal_time_s,
            report.lateness_s,
            report.skipped,
            self._missed,
            overrun.in_row,
            limits,
            check.limits,
            check.clamped,
            check.refused,
            check.sequence,
            sum(map(_FAILED, node.sender.outputs)),
            *solver,
            state,
            reason,
            report.subject,
            cause,
            0 if mode is None else mode.mode,
            *states,
            check.verdict,
            self._mode,
            arming.result,
            others if others < MOST_OTHERS else MOST_OTHERS,
            overrun.degraded,
            state in _ARMED,
            not inputs.disengaged,
            mode is not None and mode.is_autoware_control_enabled,
            sent,
            *input_values(inputs.items, inputs.ages_s),
        )
