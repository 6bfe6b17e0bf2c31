# SPDX-License-Identifier: Apache-2.0
"""Subscribes to what the page shows, like anyone else on the island's domain."""

from __future__ import annotations

from collections.abc import Callable

from safety_island.dds import topics
from safety_island.dds.endpoints import Subscription
from safety_island.dds.participant import Participant
from safety_island.dds.topics import TopicEntry
from safety_island.messages.errors import DecodeError
from safety_island.messages.inputs import (
    Odometry,
    decode_acceleration,
    decode_odometry,
    decode_steering,
)
from safety_island.messages.status import decode_status
from safety_island.messages.status_fields import Status
from safety_island.messages.trajectory import decode_trajectory
from safety_island.monitor.fields import Jerk, Measured, row, shortened
from safety_island.monitor.hub import Hub
from safety_island.monitor.rates import Rate
from safety_island.monitor.scene import path_values, pose_values
from safety_island.monitor.summary import Summary, change_of_state
from safety_island.node.inputs import INPUTS
from safety_island.status.domain import Domain

SUMMARY_EVERY_S = 0.2
POSE_EVERY_S = 0.025
"""A screen shows no more."""
SILENT_S = 1.0
"""Without a status for so long [s] the island is not heard."""


class Feed:
    """Turns what comes on the domain into messages of the hub; ``poll`` never waits."""

    def __init__(self, participant: Participant, where: str, release: str, hub: Hub) -> None:
        """Subscribe. ``where`` names the domain to a reader, ``release`` is that of Autoware."""
        self._participant, self._where, self._hub = participant, where, hub
        names = (
            (topics.TRAJECTORY, self._take_path("path")),
            (topics.PREDICTED_TRAJECTORY, self._take_path("predicted")),
            (topics.STEERING, self._take_steering),
            (topics.ACCELERATION, self._take_acceleration),
            (topics.ODOMETRY, self._take_odometry),
        )
        self._newest = [(self._subscribe(entry.of_release(release)), take) for entry, take in names]
        self._status = self._subscribe(topics.STATUS)
        self._control = self._subscribe(topics.CONTROL)
        self._control_rate = Rate()
        self._summary = Summary(Domain(participant, where), self._publisher)
        self._measured, self._jerk = Measured(), Jerk()
        self._last: Status | None = None
        self._came_at = self._said_at = self._drawn_at = float("-inf")
        self._problem = ""

    def poll(self, now: float) -> None:
        """Take what has come; ``now`` [s] is on the clock that the page shows."""
        for subscription, take in self._newest:
            sample = subscription.take_newest()
            if sample is not None:
                self._decode(take, now, sample.data)
        self._control.take_all()  # counted: what the status says was sent must be on the domain
        for sample in self._status.take_all():
            self._decode(self._take_status, now, sample.data)
        if now - self._said_at >= SUMMARY_EVERY_S:
            self._said_at = now
            self._say(now)

    def _subscribe(self, entry: TopicEntry) -> Subscription:
        return self._participant.subscription(entry.name, entry.type_name, entry.subscription_qos)

    def _decode(self, take: Callable[[float, bytes], None], now: float, data: bytes) -> None:
        """Hand a sample on; one that cannot be read is passed over, and said."""
        try:
            take(now, data)
        except DecodeError as error:
            self._problem = str(error)

    def _take_status(self, now: float, data: bytes) -> None:
        status = decode_status(data)
        values = row(now, status, self._measured, self._jerk.next(status))
        self._hub.add_row(values, shortened(values))
        self._summary.add(now, status)
        if text := change_of_state(self._last, status):
            self._hub.add_mark(now, text, "state")
        if now - self._came_at > SILENT_S:
            self._said_at = float("-inf")  # its state is shown at once
        self._last, self._came_at, self._problem = status, now, ""

    def _take_path(self, kind: str) -> Callable[[float, bytes], None]:
        def take(now: float, data: bytes) -> None:
            self._hub.publish(
                kind, {"t": round(now, 3)} | path_values(decode_trajectory(data).points)
            )

        return take

    def _take_steering(self, now: float, data: bytes) -> None:
        self._measured = self._measured._replace(steering=decode_steering(data).steering_tire_angle)

    def _take_acceleration(self, now: float, data: bytes) -> None:
        self._measured = self._measured._replace(acceleration=decode_acceleration(data).ax)

    def _take_odometry(self, now: float, data: bytes) -> None:
        odometry: Odometry = decode_odometry(data)
        self._measured = self._measured._replace(speed=odometry.vx)
        pose = pose_values(now, odometry, self._measured.steering)
        if pose is not None and now - self._drawn_at >= POSE_EVERY_S:
            self._drawn_at = now
            self._hub.publish("pose", pose)

    def _say(self, now: float) -> None:
        """Publish the state in words, or why there is none."""
        if now - self._came_at <= SILENT_S:
            rate = self._control_rate.next(now, self._control.received)
            sent = {"topic": self._control.topic, "rate_hz": rate and round(rate, 1)}
            self._hub.publish("summary", self._summary.values(now) | {"control": sent})
        else:
            self._hub.publish("silence", {"t": round(now, 3), "why": self._nothing()})

    def _nothing(self) -> str:
        looked = f"No status comes on {topics.STATUS.name} ({self._where})"
        if self._problem:
            return f"{looked} that can be read: {self._problem}; use the version of the island."
        if wrong := self._participant.mismatches():
            return f"{looked}: {wrong[0]}."
        if self._last is None:
            return f"{looked}; start 'island run', or name its --domain and --interface."
        return f"{looked} any more: the island has ended, stands still, or the network is cut."

    def _publisher(self, place: int, guid: bytes) -> str:
        """Return the ROS 2 node of a publisher, its GUID where it has no name."""
        for remote in self._participant.publications(INPUTS[place].topic.name):
            if remote.guid == guid:
                return self._participant.node_of(remote) or guid.hex()
        return guid.hex()
