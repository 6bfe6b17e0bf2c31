"""The five inputs of the controller node: how each is decoded, judged and handed on.

The way of a sample: of those that came since the last tick the newest, decode, gate (publisher,
stamp, frame), offer (every value). Whatever refuses a sample is counted here by its reason, and
leaves the controllers as they were.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

from safety_island.control.status import Refusal
from safety_island.dds import topics
from safety_island.dds.topics import TopicEntry
from safety_island.gate.content import ContentGate
from safety_island.gate.newest import newest_first, overtaken
from safety_island.gate.params import GateParams
from safety_island.gate.rate import RateMeter
from safety_island.gate.reason import SampleReason
from safety_island.gate.stamps import StampGate
from safety_island.gate.writers import Writers
from safety_island.messages import inputs as codec
from safety_island.messages.errors import DecodeError
from safety_island.messages.trajectory import Trajectory, decode_trajectory
from safety_island.node.follower import InputFollower
from safety_island.node.report import describe
from safety_island.node.transport import Sample, Subscription
from safety_island.platform.interfaces import Logger


class InputSpec(NamedTuple):
    """One row of the table of inputs."""

    name: str
    """As the follower and the log name it."""
    topic: TopicEntry
    decoder: Callable[[InputFollower], Callable[[bytes], Any]]
    """Makes the function that decodes its samples."""
    check: Callable[[ContentGate, Any, bytes, StampGate], SampleReason | None] | None
    offer: Callable[[InputFollower, Any], Refusal]
    age_limit_s: Callable[[GateParams], float] = lambda params: math.inf
    age_warning_s: Callable[[GateParams], float] = lambda params: math.inf


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
    InputSpec(
        "trajectory",
        topics.TRAJECTORY,
        _into_the_follower,
        ContentGate.trajectory,
        _offer_trajectory,
        lambda params: params.trajectory_age_limit,
    ),
    InputSpec(
        "odometry",
        topics.ODOMETRY,
        _plain(codec.decode_odometry),
        ContentGate.odometry,
        _offer_odometry,
        lambda params: params.odometry_age_limit,
        lambda params: params.age_warning,
    ),
    InputSpec(
        "steering",
        topics.STEERING,
        _plain(codec.decode_steering),
        None,
        _offer_steering,
        lambda params: params.steering_age_limit,
        lambda params: params.age_warning,
    ),
    InputSpec(
        "acceleration",
        topics.ACCELERATION,
        _plain(codec.decode_acceleration),
        ContentGate.acceleration,
        _offer_acceleration,
        lambda params: params.acceleration_age_limit,
        lambda params: params.age_warning,
    ),
    InputSpec(
        "operation mode",
        topics.OPERATION_MODE,
        _plain(codec.decode_operation_mode),
        None,
        _offer_operation_mode,
    ),
)
"""The five inputs, in the order in which a tick takes them."""


class Input:
    """One input at work: its subscription, what became of its samples, and its age.

    The moment of receipt lies between two ticks, and only the island's own clock counts, so an age
    runs from the earlier tick: the output ends in time even when the sample came at once after it.
    """

    def __init__(
        self,
        spec: InputSpec,
        subscription: Subscription,
        follower: InputFollower,
        logger: Logger,
        params: GateParams,
    ) -> None:
        self.name = spec.name
        self.topic = spec.topic.name
        self.subscription = subscription
        self.stamps = StampGate(spec.age_limit_s(params))
        self.writers = Writers(params.writer_changes)
        self.age_limit_s = spec.age_limit_s(params)
        self.age_warning_s = spec.age_warning_s(params)
        self.accepted = 0
        self.superseded = 0
        """Samples passed over for a newer one."""
        self.overtaken = 0
        """Samples that arrived after a newer one."""
        self.refused: Counter[SampleReason] = Counter()
        """Samples refused, by reason."""
        self.refused_count = self.refused_in_a_row = 0
        self.last_refusal: SampleReason | None = None
        self.rate = RateMeter(spec.topic.rate_hz)
        self.accepted_at = -math.inf
        """Monotonic time [s] before which the sample in force was not received."""
        self.writer_guid = b""
        """Writer of the sample that was taken last."""
        self.source_guid = b""
        """Writer of the sample in force."""
        self.sent_ns = 0
        """When that sample was written, by the writer's wall clock [ns]; only for reports."""
        self.stamp_ns = 0
        """Stamp of the sample in force [ns]."""
        self.message: Any = None
        """The sample in force, decoded."""
        self._other: Sample | None = None
        """The newest sample of a publisher that the island does not keep to."""
        self._decode = spec.decoder(follower)
        self._check = None if spec.check is None else partial(spec.check, ContentGate(params))
        self._offer = partial(spec.offer, follower)
        self._logger = logger

    def take(self, now: float, since: float) -> int:
        """Take what came after ``since`` [s], the tick before; return how many were refused."""
        samples = self.subscription.take_all()
        if not samples:
            return 0
        self.rate.note(len(samples), now)
        refused = 0
        if self.writers.others:
            samples, refused = self._without_foreign(samples)
        if len(samples) > 1:
            self.superseded += len(samples) - 1
            self.overtaken += overtaken(samples)
            samples = newest_first(samples)
        for sample in samples:
            if self._accept(sample, now):
                self.accepted_at = since
                break
            refused += 1
        return refused

    def _without_foreign(self, samples: Sequence[Sample]) -> tuple[Sequence[Sample], int]:
        """Leave out what others published, so that it cannot crowd out the owner's samples."""
        found = []
        for sample in samples:
            if self.writers.takes(sample.writer_guid):
                found.append(sample)
            else:
                self._other = sample
                self._refuse(SampleReason.OTHER_PUBLISHER, "other publisher")
        return found, len(samples) - len(found)

    def hand_over(self, now: float) -> None:
        """The publisher that was kept to is gone: take what another one has said meanwhile."""
        sample, self._other = self._other, None
        self.stamps.forget()  # the next one may have another clock, or tell the same again
        lives = sample is not None and sample.writer_guid in self.writers.alive
        if sample is not None and lives and self._accept(sample, now):
            self.accepted_at = now

    def drop(self) -> None:
        """Drop what waits to be taken, and forget when the sample in force came."""
        self.subscription.take_all()
        self.accepted_at = -math.inf

    @property
    def is_suspect(self) -> bool:
        """Whether rate, stamps or publishers may be worth a warning."""
        stamps = self.stamps
        return (
            self.rate.too_low
            or stamps.delay_s > 0.0
            or self.writers.others > 0
            or stamps.step_told_until > self.accepted_at  # a sample since then is too new for it
        )

    def _accept(self, sample: Sample, now: float) -> bool:
        data = sample.data
        self.writer_guid, self.sent_ns = sample.writer_guid, sample.source_timestamp_ns
        try:
            message = self._decode(data)
            reason = self._judge(message, data, now)
        except DecodeError as error:
            return self._refuse(SampleReason[error.reason.name], str(error))
        except MemoryError:
            raise
        except Exception as error:  # a fault of ours must not let one topic stop the ticks
            return self._refuse(SampleReason.FAULT, describe(error))
        if reason is not None:
            if reason is SampleReason.OTHER_PUBLISHER:
                self._other = sample
            return self._refuse(reason, reason.name.lower().replace("_", " "))
        self.stamps.hold(data, now)
        self.source_guid = sample.writer_guid
        self.accepted += 1
        self.refused_in_a_row = 0
        self.stamp_ns, self.message = self.stamps.stamp_ns, message
        return True

    def _judge(self, message: Any, data: bytes, now: float) -> SampleReason | None:
        """Pass a sample through the gate to the controllers; return why it did not get there."""
        if not self.writers.takes(self.writer_guid):
            return SampleReason.OTHER_PUBLISHER
        reason = self.stamps.judge(message.stamp, data, now)
        if reason is None and self._check is not None:
            reason = self._check(message, data, self.stamps)
        if reason is None and (verdict := self._offer(message)):
            return SampleReason[verdict.name]
        return reason

    def _refuse(self, reason: SampleReason, detail: str) -> bool:
        self.refused[reason] += 1
        self.refused_count += 1
        self.refused_in_a_row += 1
        self.last_refusal = reason
        site = f"{self.topic} {reason.name}"
        self._logger.warning("refused a sample: %s", detail, throttled=True, site=site)
        return False
