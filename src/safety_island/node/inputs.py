"""The five inputs of the controller node: how each is decoded and handed to the controllers.

The way of a sample is: newest of its topic, decode, offer. A later gate stands between the last
two; whatever refuses a sample is counted here by its reason, and leaves the controllers untouched.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from typing import Any, NamedTuple

from safety_island.control.status import Refusal
from safety_island.dds import topics
from safety_island.dds.topics import TopicEntry
from safety_island.messages import inputs as codec
from safety_island.messages.errors import DecodeError
from safety_island.messages.trajectory import Trajectory, decode_trajectory
from safety_island.node.follower import InputFollower
from safety_island.node.report import describe
from safety_island.node.transport import Subscription
from safety_island.platform.interfaces import Logger

FAULT = "fault"
"""Reason of a refusal that no sample should be able to cause."""


class InputSpec(NamedTuple):
    """One row of the table of inputs."""

    name: str
    """As the follower and the log name it."""
    topic: TopicEntry
    decoder: Callable[[InputFollower], Callable[[bytes], Any]]
    """Makes the function that decodes its samples."""
    offer: Callable[[InputFollower, Any], Refusal]


def _plain(decode: Callable[[bytes], Any]) -> Callable[[InputFollower], Callable[[bytes], Any]]:
    return lambda follower: decode


def _into_the_follower(follower: InputFollower) -> Callable[[bytes], Trajectory]:
    """Decode points into the follower's own memory; too many are refused before any is copied."""
    return lambda data: decode_trajectory(data, follower.incoming)


def _offer_trajectory(follower: InputFollower, message: Trajectory) -> Refusal:
    return follower.offer_incoming(len(message.points), message.stamp.seconds)


def _offer_odometry(follower: InputFollower, message: codec.Odometry) -> Refusal:
    _, _, _, x, y, z, qx, qy, qz, qw, vx, vy, _, _, _, wz = message
    return follower.offer_odometry(x, y, z, qx, qy, qz, qw, vx, vy, wz)


def _offer_steering(follower: InputFollower, message: codec.Steering) -> Refusal:
    return follower.offer_steering(message.steering_tire_angle)


def _offer_acceleration(follower: InputFollower, message: codec.Acceleration) -> Refusal:
    return follower.offer_acceleration(message.ax)


def _offer_operation_mode(follower: InputFollower, message: codec.OperationMode) -> Refusal:
    return follower.offer_operation_mode(message.mode, message.is_autoware_control_enabled)


INPUTS = (
    InputSpec("trajectory", topics.TRAJECTORY, _into_the_follower, _offer_trajectory),
    InputSpec("odometry", topics.ODOMETRY, _plain(codec.decode_odometry), _offer_odometry),
    InputSpec("steering", topics.STEERING, _plain(codec.decode_steering), _offer_steering),
    InputSpec(
        "acceleration",
        topics.ACCELERATION,
        _plain(codec.decode_acceleration),
        _offer_acceleration,
    ),
    InputSpec(
        "operation mode",
        topics.OPERATION_MODE,
        _plain(codec.decode_operation_mode),
        _offer_operation_mode,
    ),
)
"""The five inputs, in the order in which a tick takes them."""


class Input:
    """One input at work: its subscription, what became of its samples, and its age."""

    def __init__(
        self, spec: InputSpec, subscription: Subscription, follower: InputFollower, logger: Logger
    ) -> None:
        self.name = spec.name
        self.topic = spec.topic.name
        self.subscription = subscription
        self.accepted = 0
        self.refused: Counter[str] = Counter()
        """Samples refused, by reason."""
        self.accepted_at = -math.inf
        """Monotonic time [s] of the tick that accepted the newest sample in force."""
        self.writer_guid = b""
        """Writer of the sample that was taken last."""
        self.sent_ns = 0
        """When that sample was written, by the writer's wall clock [ns]; only for reports."""
        self._decode = spec.decoder(follower)
        self._offer = spec.offer
        self._follower = follower
        self._logger = logger

    def take(self, now: float) -> bool:
        """Take the newest sample and offer it; False when one was refused."""
        sample = self.subscription.take_newest()
        if sample is None:
            return True
        self.writer_guid = sample.writer_guid
        self.sent_ns = sample.source_timestamp_ns
        try:
            verdict = self._offer(self._follower, self._decode(sample.data))
        except DecodeError as error:
            return self._refuse(error.reason, str(error))
        except Exception as error:  # a fault of ours must not let one topic stop the ticks
            return self._refuse(FAULT, describe(error))
        if verdict:
            reason = Refusal(verdict).name.lower()
            return self._refuse(reason, reason.replace("_", " "))
        self.accepted += 1
        self.accepted_at = now
        return True

    def _refuse(self, reason: str, detail: str) -> bool:
        self.refused[str(reason)] += 1
        site = f"{self.topic} {reason}"
        self._logger.warning("refused a sample: %s", detail, throttled=True, site=site)
        return False
