"""The controller node: one tick after the other, in the order of the contract."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from safety_island.can.mode import OutputMode
from safety_island.dds import topics
from safety_island.guard import Guard
from safety_island.life_cycle.facts import Facts
from safety_island.life_cycle.life_cycle import LifeCycle
from safety_island.life_cycle.ramp import Motion
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.life_cycle.transition import Life
from safety_island.messages.wire import NANOSECONDS
from safety_island.node.arming import Arming
from safety_island.node.command import Computed, substitute
from safety_island.node.command_check import Checked, CommandCheck
from safety_island.node.controllers import NO_COMMAND, Controllers, Ran
from safety_island.node.explain import explain
from safety_island.node.follower import Follower
from safety_island.node.identity import Identity
from safety_island.node.input_set import NO_SUBJECT, NOT_BLOCKED, Blocked, InputSet
from safety_island.node.node import Node
from safety_island.node.outputs import ControlTopic, Output, ProcessingTime
from safety_island.node.report import Outcome, TickReport, describe
from safety_island.node.sender import CommandSender
from safety_island.node.status import StatusTopic
from safety_island.node.transport import Transport
from safety_island.params import IslandParameters
from safety_island.platform.interfaces import Platform, Tick

NAME = "safety_island"
ON_TIME = Tick(0, 0, 0)
MEMORY_EVERY = 64
"""Ticks between two looks at the memory in use."""
_NO_TIMES = (0, 0)
_PUBLISHED = Outcome.PUBLISHED
_SENDS = (State.READY, State.ACTIVE)
_ALARMING = (State.HOLD, State.STOP, State.SILENT)
_OUTCOMES = {
    Reason.WAITING_FOR_INPUT: Outcome.WAITING_FOR_INPUT,
    Reason.NO_TRAJECTORY: Outcome.NOT_READY,
}
"""What a tick without a command is called; FORBIDDEN for every other reason."""


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
        parameters: IslandParameters,
        outputs: Sequence[Output] | None = None,
        *,
        mode: OutputMode = OutputMode.DDS_ONLY,
        joined_at: float | None = None,
    ) -> None:
        """Enter the topics. ``outputs``: where commands go; None: to ``control_cmd`` alone.

        With ``mode`` CAN_ONLY nobody else brakes the vehicle, so a stop is declared before
        silence; ``joined_at`` [s, monotonic]: when the transport entered its domain (None: now).
        """
        super().__init__(NAME, platform, transport)
        if joined_at is None:
            joined_at = self.clock.monotonic_ns() / 1e9
        self.parameters, self.mode = parameters, mode
        self.follower = follower
        self.controllers = Controllers(follower, self.clock, self.logger)
        self.inputs = InputSet(transport, follower, self.logger, parameters.gate)
        self.identity = Identity(transport, self.inputs, self.logger, parameters, joined_at)
        self._period_s = period_s = parameters.node.ctrl_period
        timeout_s = parameters.node.timeout_thr_sec
        self.life_cycle = LifeCycle(parameters.life_cycle, period_s, not mode.uses_dds)
        guard = Guard(parameters.guard, parameters.vehicle.wheel_base, timeout_s)
        self.check = CommandCheck(guard, timeout_s, self.logger)
        self.arming = Arming(self.subscription(topics.ARM), self.logger)
        self.sender = CommandSender(self.clock, self.logger)
        self.sender.outputs = (self.control_topic(),) if outputs is None else tuple(outputs)
        self.report: TickReport | None = None
        """The last tick."""
        self.observers: list[Callable[[TickReport], None]] = []
        """Told of each tick of ``run`` after its end; they take their time from the same thread."""
        self._lateral_time, self._longitudinal_time = (
            ProcessingTime(topic, self.publisher(topic), self.logger)
            for topic in (topics.LATERAL_TIME, topics.LONGITUDINAL_TIME)
        )
        self.status = StatusTopic(self, self.publisher(topics.STATUS))
        self._ticks = 0
        self._last_tick: float | None = None

    def control_topic(self) -> ControlTopic:
        """Make the output that publishes ``control_cmd``."""
        publisher = self.publisher(topics.CONTROL)
        self.identity.own.add(publisher.guid)
        topic = ControlTopic(topics.CONTROL, publisher, self.logger)
        self.sender.topics.append(topic)
        return topic

    def on_tick(self, due: Tick) -> None:
        """Do one tick of ``run``."""
        if due.skipped:
            self.logger.warning("%d ticks were missed", due.skipped, throttled=True)
        if self._ticks % MEMORY_EVERY == 0:
            self.status.memory_bytes = self.platform.memory_bytes()
        report = self.tick(due=due)
        for observer in self.observers:
            observer(report)

    def tick(self, now: float | None = None, due: Tick = ON_TIME) -> TickReport:
        """Do one tick at ``now``, monotonic clock [s] (None: read it), and say what it did."""
        start_ns = self.clock.monotonic_ns()
        if now is None:
            now = start_ns / 1e9
        self.sender.command, self.controllers.spent_ns = None, _NO_TIMES
        refused, blocked = 0, NOT_BLOCKED
        try:
            refused = self._take(now, due.skipped)
            blocked = self._blocked(now)
            outcome, detail = self._control(blocked, now, start_ns)
        except MemoryError:  # nothing can be trusted any more: end, be silent, be started anew
            raise
        except Exception as error:  # a tick may fail, the process may not
            outcome, detail = Outcome.FAULT, describe(error)
            self.logger.error("the tick failed: %s", detail, throttled=True)
            self._fail(now)
            self.inputs.measure(now)
        self.inputs.warn(now)
        if self.sender.command is None:
            self.sender.withdraw()
        self._ticks += 1
        self._last_tick = now
        lateral_ns, longitudinal_ns = self.controllers.spent_ns
        self.report = TickReport(
            self._ticks,
            now,
            outcome,
            detail,
            self.life_cycle.life,
            blocked.subject,
            due.lateness_ns / 1e9,
            due.skipped,
            (self.clock.monotonic_ns() - start_ns) / 1e9,
            lateral_ns / 1e9,
            longitudinal_ns / 1e9,
            tuple(self.inputs.ages_s),
            refused,
            self.sender.command,
        )
        self.status.send(self.report)
        return self.report

    def close(self) -> None:
        """Close the outputs, then leave the domain."""
        self.sender.close()
        super().close()

    def _take(self, now: float, skipped: int) -> int:
        """Take what came since the last tick; what waited while the process stood still is old."""
        if self.life_cycle.begin(now, self.clock.slept_ns() / 1e9, skipped):
            self.logger.warning("the process stood still: it begins anew", throttled=True)
            self.inputs.drop()
        self.identity.look(now)
        since = now - self._period_s if self._last_tick is None else self._last_tick
        return self.inputs.take(now, since, self.clock.wall_ns())

    def _blocked(self, now: float) -> Blocked:
        """Return what forbids to send, before the controllers are asked."""
        for name in () if self.inputs.are_complete else self.inputs.missing():
            self.logger.info("Waiting for %s data", name, throttled=True, site=f"input {name}")
        blocked = self.inputs.blocked(now)
        reason = self.identity.blocked(now)
        if not reason:
            return blocked
        waits = reason is Reason.DISCOVERING and blocked.reason is Reason.WAITING_FOR_INPUT
        return blocked if waits else Blocked(reason)

    def _control(self, blocked: Blocked, now: float, start_ns: int) -> tuple[Outcome, str]:
        """From inputs that are taken to a command that is sent."""
        disengaged = self.inputs.disengaged()
        self.follower.allow_control(self.life_cycle.controls and not disengaged)
        ran = NO_COMMAND if blocked.reason else self.controllers.run(now)
        if not blocked.reason and ran is NO_COMMAND:
            self.logger.info("Waiting for a trajectory that can be followed", throttled=True)
            blocked = Blocked(Reason.NO_TRAJECTORY)
        checked = self._check(ran, now, start_ns, not disengaged)
        asked = self.arming.take()
        facts = Facts(
            blocked.reason,
            disengaged,
            self.inputs.speed(),
            asked,
            bool(ran.fault),
            ran.unsolved,
            checked.refusal,
        )
        before = self.life_cycle.state
        life = self.life_cycle.judge(facts, now)
        if life.state is not before:
            self._tell(life, blocked.subject)
        if asked:
            self.arming.answer(before, life.state)
        if ran.command is not None:
            self._tell_times()
        return self._send(checked, now)

    def _check(self, ran: Ran, now: float, start_ns: int, engaged: bool) -> Checked:
        """Ask the guard about the command of the controllers."""
        if ran.command is None:
            return Checked(None, outcome=Outcome.FAULT, detail=ran.fault)
        now += (self.clock.monotonic_ns() - start_ns) / 1e9
        return self.check.check(
            ran.command, now, self.inputs.speed(), self.inputs.steering(), engaged
        )

    def _send(self, checked: Checked, now: float) -> tuple[Outcome, str]:
        """Send what the state lets out."""
        life = self.life_cycle.life
        if life.state in _SENDS and checked.command is not None:
            sent = self._publish(checked.command, _PUBLISHED)
            motion = tuple.__new__(Motion, checked.command[2:6])
            self.life_cycle.sent(motion, sent[0] is _PUBLISHED, now)
            return sent
        if (substituted := self.life_cycle.motion()) is not None:
            if checked.command is not None:
                self.check.forget()  # what was not sent is nothing to measure a change against
            return self._substitute(substituted, now)
        self.check.forget()
        if life.state in _SENDS:
            return checked.outcome, checked.detail
        return _OUTCOMES.get(life.reason, Outcome.FORBIDDEN), self._detail(life.reason)

    def _substitute(self, motion: Motion, now: float) -> tuple[Outcome, str]:
        """Send a command of the life cycle; the guard judges it like any other."""
        speed, steering = self.inputs.speed(), self.inputs.steering()
        checked = self.check.check(substitute(motion, now), now, speed, steering, False)
        if checked.command is None:
            return checked.outcome, checked.detail
        return self._publish(checked.command, Outcome.SUBSTITUTED)

    def _fail(self, now: float) -> None:
        """End a tick that an exception has ended; a stop goes on, whatever fails in it."""
        before, life = self.life_cycle.state, self.life_cycle.fault()
        if life.state is not before:
            self._tell(life, NO_SUBJECT)
        if self.sender.command is not None or (motion := self.life_cycle.motion()) is None:
            return
        self.check.forget()  # who knows what it has seen in this tick
        try:
            self._substitute(motion, now)
        except MemoryError:
            raise
        except Exception as error:
            self.logger.error("the stop failed: %s", describe(error), throttled=True)

    def _publish(self, result: Computed, sent: Outcome) -> tuple[Outcome, str]:
        """Send a command, and say how that ended."""
        if self.sender.send(result):
            return sent, ""
        return Outcome.OUTPUT_FAILED, ", ".join(output.name for output in self.sender.outputs)

    def _tell_times(self) -> None:
        stamp = divmod(self.clock.wall_ns(), NANOSECONDS)
        lateral_ns, longitudinal_ns = self.controllers.spent_ns
        self._lateral_time.send(stamp, lateral_ns)
        self._longitudinal_time.send(stamp, longitudinal_ns)

    def _detail(self, reason: Reason) -> str:
        if reason is Reason.WAITING_FOR_INPUT:
            return ", ".join(self.inputs.missing())
        return reason.name.lower().replace("_", " ")

    def _tell(self, life: Life, subject: int) -> None:
        """Log a change of state; one that comes and goes is told now and then."""
        state, meaning = life.state.name, explain(life.reason, subject)
        log = self.logger.warning if life.state in _ALARMING else self.logger.info
        log("state %s: %s", state, meaning, throttled=True, site=f"{state} {life.reason.name}")
