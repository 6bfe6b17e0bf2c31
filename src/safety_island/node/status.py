"""What the island tells of itself in every tick: its status, on a topic of its own."""

from __future__ import annotations

from typing import TYPE_CHECKING

from safety_island.dds import topics
from safety_island.life_cycle.state import State
from safety_island.messages.status import StatusWriter
from safety_island.node.input_status import InputStatusFiller
from safety_island.node.outputs import TopicWriter
from safety_island.node.trace_status import TraceStatus
from safety_island.node.transport import Publisher

if TYPE_CHECKING:
    from safety_island.node.controller import ControllerNode
    from safety_island.node.report import TickReport

_ARMED = (State.ACTIVE, State.HOLD, State.STOP)
_NANOSECONDS = 1_000_000_000


class StatusTopic(TopicWriter):
    """Publishes ``safety_island_msgs/msg/Status``, written into one record again and again."""

    def __init__(self, node: ControllerNode, publisher: Publisher) -> None:
        super().__init__(topics.STATUS, publisher, node.logger)
        self.memory_bytes = 0
        """Resident set size, as it was looked up last."""
        self._node = node
        self._writer = StatusWriter()
        self._writer.fields.output_mode[0] = int(node.mode)
        self._inputs = [
            InputStatusFiller(item, cells)
            for item, cells in zip(node.inputs.items, self._writer.inputs, strict=True)
        ]
        self._trace = TraceStatus(node.follower.trace, self._writer)
        self._commands = self._missed = 0

    def send(self, report: TickReport) -> None:
        """Publish the status after a tick; a failure is no reason to stop."""
        self._fill_tick(report)
        self._fill_life(report)
        self._fill_command(report)
        node, fields = self._node, self._writer.fields
        if report.lateral_time_s:
            self._trace.fill()
        else:
            self._trace.clear()
        bits = node.inputs.warnings
        for filler, warned in zip(self._inputs, bits, strict=True):
            filler.fill(report.now, warned)
        sec, nanosec = divmod(node.clock.wall_ns(), _NANOSECONDS)
        fields.stamp.sec[0], fields.stamp.nanosec[0] = sec, nanosec
        self.write(self._writer.encode())

    def _fill_tick(self, report: TickReport) -> None:
        fields = self._writer.fields
        fields.tick[0] = report.number
        fields.tick_time[0] = report.tick_time_s
        fields.lateral_time[0] = report.lateral_time_s
        fields.longitudinal_time[0] = report.longitudinal_time_s
        fields.lateness[0] = report.lateness_s
        self._missed += report.skipped
        fields.missed_periods[0] = report.skipped
        fields.missed_periods_total[0] = self._missed
        fields.memory[0] = self.memory_bytes

    def _fill_life(self, report: TickReport) -> None:
        node, fields, life = self._node, self._writer.fields, report.life
        overrun, mode = node.life_cycle.overrun, node.inputs.operation_mode
        fields.state[0], fields.reason[0], fields.latched_cause[0] = life
        fields.subject[0] = report.subject
        fields.overruns[0], fields.degraded[0] = overrun.in_row, overrun.degraded
        fields.armed[0] = life.state in _ARMED
        fields.engaged[0] = not node.inputs.disengaged()
        if mode is not None:
            fields.operation_mode[0] = mode.mode
            fields.control_enabled[0] = mode.is_autoware_control_enabled
        fields.arm_nonce[0], fields.arm_result[0] = node.arming.nonce, int(node.arming.result)
        fields.other_control_writers[0] = min(len(node.identity.islands.others), 255)

    def _fill_command(self, report: TickReport) -> None:
        fields, check = self._writer.fields, self._node.check
        fields.guard_verdict[0], fields.guard_limits[0] = int(check.verdict), check.limits
        fields.guard_clamped[0], fields.guard_refused[0] = check.clamped, check.refused
        fields.sequence[0] = check.sequence
        fields.output_failures[0] = sum([output.failed for output in self._node.outputs])
        went_out = report.sent
        self._commands += went_out
        fields.commands[0], fields.published[0] = self._commands, went_out
        command = report.command
        if command is None or not went_out:
            self._writer.clear_command()
            return
        fields.command_angle[0] = command.steering_tire_angle
        fields.command_rate[0] = command.steering_tire_rotation_rate
        fields.command_velocity[0] = command.velocity
        fields.command_acceleration[0] = command.acceleration
