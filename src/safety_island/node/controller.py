# SPDX-License-Identifier: Apache-2.0
"""The controller node: one tick after the other, in the order of the contract."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from safety_island.command.mode import OutputMode
from safety_island.control.release import rules_of
from safety_island.core.guard import Guard
from safety_island.dds import topics
from safety_island.dds.topics import TopicEntry
from safety_island.life_cycle.facts import Facts
from safety_island.life_cycle.life_cycle import LifeCycle
from safety_island.life_cycle.reason import Reason
from safety_island.node.arming import Arming
from safety_island.node.command_check import CommandCheck
from safety_island.node.command_path import CommandPath
from safety_island.node.controllers import NO_COMMAND, Controllers
from safety_island.node.explain import tell_state
from safety_island.node.follower import Follower
from safety_island.node.identity import Identity
from safety_island.node.input_set import NO_SUBJECT, NOT_BLOCKED, Blocked, InputSet
from safety_island.node.node import Node
from safety_island.node.outputs import ControlTopic, Output, ProcessingTimes, TopicWriter
from safety_island.node.report import Outcome, TickReport, describe
from safety_island.node.sender import CommandSender
from safety_island.node.status import StatusTopic
from safety_island.node.steering_offset import SteeringOffset
from safety_island.node.transport import Transport
from safety_island.params import IslandParameters
from safety_island.platform.interfaces import Platform, Tick

NAME = "safety_island"
ON_TIME = Tick(0, 0, 0)
MEMORY_EVERY = 64
"""Ticks between two looks at the memory in use."""


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
        where: str = "",
    ) -> None:
        """Enter the topics. ``outputs``: where commands go; None: to ``control_cmd`` alone.

        With ``mode`` CAN_ONLY nobody else brakes the vehicle, so a stop is declared before
        silence; ``joined_at`` [s, monotonic]: when the transport entered its domain (None: now);
        ``where`` names domain and interface, for the line that says what is waited for.
        """
        super().__init__(NAME, platform, transport)
        if joined_at is None:
            joined_at = self.clock.monotonic_ns() / 1e9
        self.parameters, self.mode = parameters, mode
        self._where = f" on {where}" if where else ""
        self.follower = follower
        self.controllers = Controllers(follower, self.clock, self.logger)
        self._release = release = parameters.node.autoware_release
        self.inputs = InputSet(
            transport, follower, self.clock, self.logger, parameters.gate, release
        )
        self._offset = self._steering_offset()
        self._period_s = period_s = parameters.node.ctrl_period
        timeout_s = parameters.node.timeout_thr_sec
        self.life_cycle = LifeCycle(parameters.life_cycle, period_s, not mode.uses_dds)
        islands = self.life_cycle.memory["islands"]
        self.identity = Identity(
            transport, self.inputs, self.logger, parameters, joined_at, islands
        )
        guard = Guard(parameters.guard, parameters.vehicle.wheel_base, timeout_s)
        self.check = CommandCheck(guard, timeout_s, self.logger)
        self.arming = Arming(self.subscription(topics.ARM), self.logger)
        self.sender = CommandSender(self.clock, self.logger)
        self.sender.outputs = (self.control_topic(),) if outputs is None else tuple(outputs)
        self._path = CommandPath(self.check, self.life_cycle, self.sender, self.inputs, self.logger)
        self.report: TickReport | None = None
        """The last tick."""
        self.observers: list[Callable[[TickReport], None]] = []
        """Told of each tick of ``run`` after its end; they take their time from the same thread."""
        time_topics = topics.of_release((topics.LATERAL_TIME, topics.LONGITUDINAL_TIME), release)
        self._times = ProcessingTimes(*map(self._writer, time_topics))
        self.status = StatusTopic(self, self.publisher(topics.STATUS))
        self.status.memory_bytes = platform.memory_bytes()
        self._ticks = 0
        self._last_tick: float | None = None

    def control_topic(self) -> ControlTopic:
        """Make the output that publishes ``control_cmd``."""
        publisher = self.publisher(topics.CONTROL)
        self.identity.own.add(publisher.guid)
        topic = ControlTopic(topics.CONTROL, publisher, self.logger)
        self.sender.topics.append(topic)
        return topic

    def _steering_offset(self) -> SteeringOffset | None:
        """Subscribe to the offset of the steering sensor, where the release has that topic."""
        enabled = self.parameters.lateral.steering_offset_enable_auto_steering_offset_removal
        if not enabled or not rules_of(self._release).steering_offset_is_input:
            return None
        return SteeringOffset(self.subscription(topics.STEERING_OFFSET), self.follower, self.logger)

    def _writer(self, topic: TopicEntry) -> TopicWriter:
        return TopicWriter(topic, self.publisher(topic), self.logger)

    def on_tick(self, due: Tick) -> None:
        """Do one tick of ``run``."""
        if due.skipped:
            self.logger.warning("%d ticks were missed", due.skipped, throttled=True)
        report = self.tick(due=due)
        for observer in (self._look_at_memory, *self.observers):
            try:
                observer(report)
            except MemoryError:
                raise
            except Exception as error:  # what only looks on must not stop what drives
                self.logger.error("an observer failed: %s", describe(error), throttled=True)

    def _look_at_memory(self, report: TickReport) -> None:
        if report.number % MEMORY_EVERY == 0:
            self.status.memory_bytes = self.platform.memory_bytes()

    def tick(self, now: float | None = None, due: Tick = ON_TIME) -> TickReport:
        """Do one tick at ``now``, monotonic clock [s] (None: read it), and say what it did."""
        start_ns = self.clock.monotonic_ns()
        if now is None:
            now = start_ns / 1e9
        self.sender.command = None
        self.controllers.begin()
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
        self._end(now)
        self._ticks += 1
        self._last_tick = now
        lateral_ns, longitudinal_ns = self.controllers.spent_ns
        values = (
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
        self.report = report = tuple.__new__(TickReport, values)  # in half the constructor's time
        self.status.send(report)
        return report

    def may_end(self) -> bool:
        """Whether no vehicle has to be braked first."""
        return not self.life_cycle.must_stop

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
        self.sender.listen()
        if self._offset is not None:
            self._offset.take()
        since = now - self._period_s if self._last_tick is None else self._last_tick
        return self.inputs.take(now, since)

    def _blocked(self, now: float) -> Blocked:
        """Return what forbids to send, before the controllers are asked."""
        if not self.inputs.are_complete and (names := self.inputs.missing()):
            awaited = ", ".join(f"{name} data" for name in names)
            self.logger.info(
                "Waiting for %s%s", awaited, self._where, throttled=True, site="inputs"
            )
        blocked = self.inputs.blocked(now)
        reason = self._refuses(now)
        if not reason:
            return blocked
        waits = reason is Reason.DISCOVERING and blocked.reason is Reason.WAITING_FOR_INPUT
        return blocked if waits else Blocked(reason)

    def _refuses(self, now: float) -> Reason:
        """Why nothing may be sent, whatever the inputs are; NONE when it may."""
        if self.is_ending:
            return Reason.SHUTTING_DOWN
        if self.sender.foreign_frames and not self.life_cycle.is_armed:  # who drives, drives on
            return Reason.SECOND_CAN_MASTER
        return self.identity.blocked(now)

    def _lacks_only_a_path(self, blocked: Blocked, now: float) -> bool:
        """Whether what forbids to send is that no trajectory that came can be followed."""
        if blocked.reason is Reason.INPUT_STALE:
            return self.inputs.lacks_only_a_path(now)
        return blocked.reason is Reason.NO_TRAJECTORY

    def _control(self, blocked: Blocked, now: float, start_ns: int) -> tuple[Outcome, str]:
        """From inputs that are taken to a command that is sent."""
        disengaged = self.inputs.disengaged
        self.follower.allow_control(self.life_cycle.controls and not disengaged)
        ran = NO_COMMAND if blocked.reason else self.controllers.run(now)
        if not blocked.reason and ran is NO_COMMAND:
            self.logger.info("Waiting for a trajectory that can be followed", throttled=True)
            blocked = Blocked(Reason.NO_TRAJECTORY)
        since_start_s = (self.clock.monotonic_ns() - start_ns) / 1e9
        checked = self._path.check(ran, now + since_start_s, not disengaged)
        asked = self.arming.take()
        speed = self.inputs.speed()
        what_failed = bool(ran.fault), ran.unsolved, checked.refusal
        lost = ran.off_path or (bool(blocked.reason) and self._lacks_only_a_path(blocked, now))
        facts = tuple.__new__(Facts, (blocked.reason, disengaged, speed, asked, *what_failed, lost))
        before = self.life_cycle.state
        life = self.life_cycle.judge(facts, now)
        if life.state is not before:
            tell_state(self.logger, life, blocked.subject)
        if asked:
            self.arming.answer(before, life.state)
        if ran.command is not None:
            self._times.send(self.clock.wall_ns(), self.controllers.spent_ns)
        return self._path.send(checked, now)

    def _end(self, now: float) -> None:
        """Take back what no longer stands, and look for warnings; neither may end the process."""
        try:
            if self.sender.command is None:
                self.sender.withdraw()
            self.inputs.warn(now)
        except MemoryError:
            raise
        except Exception as error:
            self.logger.error("the end of a tick failed: %s", describe(error), throttled=True)

    def _fail(self, now: float) -> None:
        """End a tick that an exception has ended."""
        self.check.skip()
        before, life = self.life_cycle.state, self.life_cycle.fault()
        if life.state is not before:
            tell_state(self.logger, life, NO_SUBJECT)
        self._path.carry_on(now)
        self.inputs.measure(now)
