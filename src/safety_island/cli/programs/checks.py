# SPDX-License-Identifier: Apache-2.0
"""What the test program checks: a node's timer, a topic over DDS, the way to a command."""

from __future__ import annotations

import time

from safety_island.cli.programs.samples import sample
from safety_island.control.follower import TrajectoryFollower
from safety_island.dds import topics
from safety_island.dds.participant import Participant
from safety_island.dds.topics import TopicEntry
from safety_island.messages.outputs import decode_control
from safety_island.messages.wire import Time
from safety_island.node import ControllerNode
from safety_island.node.node import Node
from safety_island.node.report import TickReport
from safety_island.params import load_set
from safety_island.platform import Platform
from safety_island.platform.interfaces import Tick

TICKS = 5
_LIMIT_S = 20.0
_PERIOD_S = 0.02


class Failure(Exception):
    """What a check expected, and what it found."""


class _Counter(Node):
    """Keeps the times of its ticks and stops after a few."""

    def __init__(self, platform: Platform, participant: Participant) -> None:
        super().__init__("unit_test", platform, participant)
        self.due_ns: list[int] = []

    def on_tick(self, due: Tick) -> None:
        self.due_ns.append(due.due_ns)
        if len(self.due_ns) == TICKS:
            self.stop()


def ticks(platform: Platform, own: Participant) -> None:
    """Check that a node ticks on a grid. Raises Failure."""
    node = _Counter(platform, own)
    node.run(_PERIOD_S, _LIMIT_S)
    period_ns = round(_PERIOD_S * 1e9)
    steps = [later - earlier for earlier, later in zip(node.due_ns, node.due_ns[1:], strict=False)]
    if len(steps) != TICKS - 1 or any(step <= 0 or step % period_ns for step in steps):
        raise Failure(f"expected {TICKS} ticks {period_ns} ns apart, found steps of {steps} ns")


def round_trip(own: Participant, peer: Participant, entry: TopicEntry) -> None:
    """Check that a message of a topic comes through as it was sent. Raises Failure."""
    publisher = peer.publisher(entry.name, entry.type_name, entry.qos)
    subscription = own.subscription(entry.name, entry.type_name, entry.subscription_qos)
    end = time.monotonic() + _LIMIT_S
    try:
        while not (publisher.matched() and subscription.matched()):
            _check_time(end, "the two ends do not find each other")
            own.wait(0.02)
        data = sample(entry, Time(1, 2), 0.0)
        if not publisher.write(data):
            raise Failure(publisher.last_error)
        while (found := subscription.take_newest()) is None:
            _check_time(end, "no message came")
            own.wait(0.02)
        if found.data[: len(data)] != data:
            raise Failure("the message came back changed")
    finally:
        publisher.close()
        subscription.close()


def command(platform: Platform, own: Participant, peer: Participant) -> None:
    """Check that five inputs lead to a control command. Raises Failure.

    The vehicle stands: an island that starts in a moving one gives no command.
    """
    parameters = load_set("default")
    publishers = [
        (entry, peer.publisher(entry.name, entry.type_name, entry.qos)) for entry in topics.INPUTS
    ]
    control = peer.subscription(topics.CONTROL.name, topics.CONTROL.type_name, topics.CONTROL.qos)
    node = ControllerNode(platform, own, TrajectoryFollower(parameters), parameters)
    received = []

    def feed(_: TickReport) -> None:
        stamp = Time.from_nanoseconds(platform.clock.wall_ns())
        for entry, publisher in publishers:
            publisher.write(sample(entry, stamp, travelled=0.0, speed=0.0))
        if (found := control.take_newest()) is not None:
            received.append(decode_control(found.data))
            node.stop()

    node.observers.append(feed)
    node.run(_PERIOD_S, _LIMIT_S)
    if not received:
        raise Failure(f"no control command within {_LIMIT_S:g} s; {node.report}")
    if abs(received[0].steering_tire_angle) > 0.1:
        raise Failure(f"straight on, the command steers: {received[0]}")


def _check_time(end: float, what: str) -> None:
    if time.monotonic() > end:
        raise Failure(f"{what} within {_LIMIT_S:g} s")
