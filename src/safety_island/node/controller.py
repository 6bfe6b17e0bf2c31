"""The controller node: one tick after the other, in the order of the contract."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from safety_island.control.params import NodeParams
from safety_island.control.status import MpcStatus
from safety_island.dds import topics
from safety_island.messages.outputs import Control
from safety_island.messages.wire import Time
from safety_island.node.command import computed
from safety_island.node.follower import Follower
from safety_island.node.inputs import INPUTS, Input
from safety_island.node.node import Node
from safety_island.node.outputs import ControlTopic, Output, ProcessingTime
from safety_island.node.report import Outcome, TickReport, describe
from safety_island.node.transport import Transport
from safety_island.platform.interfaces import Platform, Tick

NAME = "safety_island"
ON_TIME = Tick(0, 0, 0)
_NO_TIMES = (0, 0)


class ControllerNode(Node):
    """Five inputs, two controllers, one command every period.

    ``run`` drives it on the platform's timer; a replay or a simulation delivers its bytes and calls
    ``tick``. A tick waits for nothing, and no input can stop it.
    """

    def __init__(
        self,
        platform: Platform,
        transport: Transport,
        follower: Follower,
        parameters: NodeParams,
        outputs: Sequence[Output] | None = None,
    ) -> None:
        """Enter the topics. ``outputs``: where commands go; None: to ``control_cmd`` alone."""
        super().__init__(NAME, platform, transport)
        self.parameters = parameters
        self.follower = follower
        self.inputs = tuple(
            Input(spec, self.subscription(spec.topic), follower, self.logger) for spec in INPUTS
        )
        self.outputs = tuple(outputs) if outputs is not None else (self.control_topic(),)
        self.report: TickReport | None = None
        """The last tick."""
        self.observers: list[Callable[[TickReport], None]] = []
        """Told of each tick of ``run`` after its end; they take their time from the same thread."""
        self._times = tuple(
            ProcessingTime(topic, self.publisher(topic), self.logger)
            for topic in (topics.LATERAL_TIME, topics.LONGITUDINAL_TIME)
        )
        self._ticks = 0
        self._is_complete = False
        self._stamp = follower.command["stamp"]
        """Of the lateral part: the kernels leave it to their caller."""
        self._command: Control | None = None
        self._spent_ns = _NO_TIMES

    def control_topic(self) -> ControlTopic:
        """Make the output that publishes ``control_cmd``."""
        return ControlTopic(topics.CONTROL, self.publisher(topics.CONTROL), self.logger)

    def on_tick(self, due: Tick) -> None:
        """Do one tick of ``run``."""
        if due.skipped:
            self.logger.warning("%d ticks were missed", due.skipped, throttled=True)
        report = self.tick(due=due)
        for observer in self.observers:
            observer(report)

    def tick(self, now: float | None = None, due: Tick = ON_TIME) -> TickReport:
        """Do one tick at ``now``, monotonic clock [s] (None: read it), and say what it did."""
        start_ns = self.clock.monotonic_ns()
        if now is None:
            now = start_ns / 1e9
        refused, self._command, self._spent_ns = 0, None, _NO_TIMES
        try:
            for item in self.inputs:
                refused += not item.take(now)
            outcome, detail = self._control(now, start_ns)
        except Exception as error:  # a tick may fail, the process may not
            outcome, detail = Outcome.FAULT, describe(error)
            self.logger.error("the tick failed: %s", detail, throttled=True)
        self._ticks += 1
        lateral_ns, longitudinal_ns = self._spent_ns
        self.report = TickReport(
            self._ticks,
            now,
            outcome,
            detail,
            due.lateness_ns / 1e9,
            due.skipped,
            (self.clock.monotonic_ns() - start_ns) / 1e9,
            lateral_ns / 1e9,
            longitudinal_ns / 1e9,
            tuple([now - item.accepted_at for item in self.inputs]),
            refused,
            self._command,
        )
        return self.report

    def close(self) -> None:
        """Close the outputs, then leave the domain."""
        for output in self.outputs:
            output.close()
        super().close()

    def _control(self, now: float, start_ns: int) -> tuple[Outcome, str]:
        """From inputs that are taken to a command that is sent."""
        if not self._is_complete and (missing := self._missing()):
            return Outcome.WAITING_FOR_INPUT, missing
        if not self.follower.is_ready() or not self._run_controllers(now):
            self.logger.info("Waiting for a trajectory that can be followed", throttled=True)
            return Outcome.NOT_READY, "no trajectory that can be followed"
        outcome, detail = self._publish(now, start_ns)
        stamp = Time.from_nanoseconds(self.clock.wall_ns())
        for topic, spent_ns in zip(self._times, self._spent_ns, strict=True):
            topic.send(stamp, spent_ns / 1e9)
        return outcome, detail

    def _missing(self) -> str:
        """Name the inputs without which there is no tick, and log each; empty when none."""
        missing = self.follower.missing()
        self._is_complete = not missing
        for name in missing:
            self.logger.info("Waiting for %s data", name, throttled=True, site=f"input {name}")
        return ", ".join(missing)

    def _run_controllers(self, now: float) -> bool:
        """Run lateral, then longitudinal, then hand over; False when there is no new command."""
        begin_ns = self.clock.monotonic_ns()
        status = self.follower.run_lateral(now)
        if status == MpcStatus.NO_REFERENCE:
            return False
        self._stamp[0] = now
        middle_ns = self.clock.monotonic_ns()
        if self.follower.run_longitudinal(now) < 0:
            return False
        self._spent_ns = (middle_ns - begin_ns, self.clock.monotonic_ns() - middle_ns)
        self.follower.sync()
        if status != MpcStatus.SOLVED:
            reason = MpcStatus(status).name.lower().replace("_", " ")
            self.logger.warning("no new steering angle: %s", reason, throttled=True, site="mpc")
        return True

    def _publish(self, now: float, start_ns: int) -> tuple[Outcome, str]:
        """Refuse what is stale or not finite; else give the command to every output."""
        result, now_ns = computed(self.follower.command), self.clock.monotonic_ns()
        oldest = now + (now_ns - start_ns) / 1e9 - self.parameters.timeout_thr_sec
        if side := result.stale_side(oldest):
            self.logger.error("refused a stale %s command", side, throttled=True)
            return Outcome.STALE, side
        if not result.is_finite():
            self.logger.error("refused a command that is not finite: %s", result, throttled=True)
            return Outcome.NOT_FINITE, "command"
        self._command = command = result.to_control(self.clock.wall_ns() - now_ns)
        stamp_ns = command.stamp.nanoseconds
        sent = [output.send(command, stamp_ns) for output in self.outputs]
        if any(sent):
            return Outcome.PUBLISHED, ""
        return Outcome.OUTPUT_FAILED, ", ".join(output.name for output in self.outputs)
