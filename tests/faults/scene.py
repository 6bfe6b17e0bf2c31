# SPDX-License-Identifier: Apache-2.0
"""A closed loop in virtual time: vehicle and planner, faulty wires, the island, and a log of it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import cache
from typing import NamedTuple

from safety_island.can.link import DirectLink
from safety_island.can.mock import MockBus
from safety_island.can.output import CanOutput
from safety_island.command.mode import OutputMode
from safety_island.control.follower import TrajectoryFollower
from safety_island.control.status import Mode
from safety_island.dds import topics
from safety_island.input_gate.reason import SampleReason
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.messages.outputs import Control
from safety_island.node.controller import ControllerNode
from safety_island.node.input import Input
from safety_island.node.memory import MemoryDomain
from safety_island.node.report import Outcome, TickReport
from safety_island.params import IslandParameters, from_mapping
from safety_island.platform import LogConfig
from safety_island.platform.sim import make
from safety_island.platform.sim.clock import SimClock
from safety_island.sim.courses import load_course
from safety_island.sim.main_compute import PERIOD_NS, PLAN_EVERY, MainCompute
from safety_island.sim.world import World
from tests.faults.remote import RemoteClock, Wires
from tests.faults.wire import Fault, healthy

INPUTS = ("trajectory", "odometry", "steering", "acceleration", "operation_mode")
"""Keys of the inputs, in the order in which a tick takes them."""


AGED = INPUTS[:4]
"""Those with an age limit."""


FAST, SLOW = 0.03, 0.15
"""Control periods [s]."""


EPOCH_NS = 1_700_000_000 * 10**9
"""What the wall clocks of both machines are ahead of virtual time."""


START_SPEED = 5.0
"""Speed [m/s] at which a scene begins, so that nothing waits for the vehicle to speed up."""


SETTLE_S = 3.0


@cache
def parameters(period_s: float, **overrides: object) -> IslandParameters:
    """Return the default set at a period [s], with some values replaced."""
    return from_mapping({"ctrl_period": period_s} | overrides)


class Row(NamedTuple):
    """One tick: its time [s], state and reason after it, and what it let out."""

    at: float
    state: State
    reason: Reason
    subject: int
    output: str
    """``published``, ``held``, ``ramp``, or ``silent``: nothing on DDS, nothing on CAN."""
    command: Control | None
    speed: float
    """Of the vehicle [m/s]."""
    skipped: int
    outcome: Outcome


_SUBSTITUTES = {State.HOLD: "held", State.STOP: "ramp"}


class Scene:
    """The loop; ``rows`` is its log. CAN_ONLY (``has_ramp``) drives the vehicle by CAN alone."""

    def __init__(
        self,
        period_s: float = SLOW,
        *,
        has_ramp: bool = False,
        course: str = "s-curve",
        start_ns: int | None = None,
        domain: Callable[[SimClock], MemoryDomain] = MemoryDomain,
        absent: Iterable[str] = (),
        start_speed: float = START_SPEED,
        skew_ns: int = 0,
        overrides: Mapping[str, object] | None = None,
    ) -> None:
        self.period_s = period_s
        self.platform = make(LogConfig())
        self.clock = self.platform.clock
        self.clock.advance_to_ns(start_ns or 0)
        self.remote_clock = RemoteClock(self.clock)
        self.clock.set_wall_offset_ns(EPOCH_NS)
        self.remote_clock.set_wall_offset_ns(EPOCH_NS + skew_ns)
        self.domain = domain(self.clock)
        wires = Wires(self.clock, self.domain)
        self.world = World(load_course(course), self.now, repeat=True, leave=False)
        self.world.plant.speed = start_speed
        self.main_compute = MainCompute(self.world, wires, self.remote_clock)
        self.wires = {key: wires.by_topic[topics.topic(key).name] for key in INPUTS}
        for key in absent:
            self.wires[key].stop()
        self.parameters = parameters(period_s, **(overrides or {}))
        self.follower = TrajectoryFollower(self.parameters)
        self.node = self.new_node(has_ramp)
        self.bus = MockBus()
        self._attach_can(has_ramp)
        self.rows: list[Row] = []
        self._heard = self.domain.subscription(
            topics.CONTROL.name, topics.CONTROL.type_name, topics.CONTROL.subscription_qos
        )
        self.node.observers.append(self._log)
        self.timer = self.platform.new_timer(period_s)
        self._rounds = 0
        self._act()

    def new_node(self, has_ramp: bool = False) -> ControllerNode:
        """Make an island on the domain of the scene."""
        mode = OutputMode.CAN_ONLY if has_ramp else OutputMode.DDS_AND_CAN
        return ControllerNode(self.platform, self.domain, self.follower, self.parameters, mode=mode)

    def _attach_can(self, only: bool) -> None:
        mode = OutputMode.CAN_ONLY if only else OutputMode.DDS_AND_CAN
        link = DirectLink(self.bus, self.clock.monotonic_ns)
        self.bus.open()
        can = CanOutput(
            mode, link, self.period_s / 10, self.clock.monotonic_ns, self.platform.logger
        )
        self.node.sender.outputs = (can,) if only else (*self.node.sender.outputs, can)
        self._drives_by_can = only

    @property
    def now(self) -> float:
        """Virtual time, monotonic [s]."""
        return self.clock.monotonic_ns() / 1e9

    def _act(self) -> None:
        """Let the main compute do a round, and come again in one of its periods."""
        self.main_compute.take_command()
        self.world.advance(self.now)
        self.main_compute.publish_vehicle()
        if self._rounds % PLAN_EVERY == 0:
            self.main_compute.publish_plan()
        self._rounds += 1
        self.clock.call_at(self.clock.monotonic_ns() + PERIOD_NS, self._act)

    def _log(self, report: TickReport) -> None:
        """Note a tick; what it let out is what was heard, not what it says."""
        triples, rest = divmod(len(self.bus.frames), 3)
        assert not rest, "a torn triple"
        self.bus.frames.clear()
        heard = len(self._heard.take_all())
        command = report.command
        if self._drives_by_can and triples and command is not None:
            angle, acceleration = command.steering_tire_angle, command.acceleration
            self.world.offer_command(self.now, angle, acceleration)
        output = "silent"
        if heard or triples:
            output = _SUBSTITUTES.get(report.life.state, "published")
        life, speed = report.life, self.world.plant.speed
        sent = command if output != "silent" else None
        self.rows.append(
            Row(report.now, life.state, life.reason, report.subject, output, sent, speed,
                report.skipped, report.outcome)
        )  # fmt: skip

    # Moving on.

    def tick(self) -> Row:
        """Move on to the next place on the grid, and do that tick."""
        due = self.timer.wait()
        assert due is not None
        self.node.on_tick(due)
        return self.rows[-1]

    def run(self, seconds: float) -> list[Row]:
        """Do the ticks of so much time [s]; return them."""
        begin, end = len(self.rows), self.now + seconds - 1e-6
        while self.now + self.period_s <= end + self.period_s / 2:
            self.tick()
        return self.rows[begin:]

    def drive(self) -> Scene:
        """Engage and drive on until everything has settled."""
        rows = self.run(SETTLE_S)
        assert rows[-1].state is State.ACTIVE, rows[-1]
        return self

    def idle(self, seconds: float) -> None:
        """Let time pass without a tick, as between two ticks."""
        self.clock.advance_to_ns(self.clock.monotonic_ns() + round(seconds * 1e9))

    # Faults.

    def inject(self, fault: Fault, *keys: str) -> float:
        """Put a fault on wires (none named: on all); return the time [s]."""
        for key in keys or INPUTS:
            self.wires[key].fault = fault
        return self.now

    def clear(self) -> None:
        """Mend every wire."""
        self.inject(healthy)

    def input(self, key: str) -> Input:
        """Return an input of the island."""
        return self.node.inputs.items[INPUTS.index(key)]

    def refused(self, key: str, reason: SampleReason) -> int:
        """Count the samples of an input that were refused for a reason."""
        return self.input(key).refused[reason]

    def disengage(self) -> None:
        """Leave autonomous mode; the main compute engages it again as soon as commands come."""
        self.world.mode, self.world.gate.engaged = Mode.STOP, False

    @property
    def log_text(self) -> str:
        """What the island has logged."""
        return "".join(self.platform.logger.lines)
