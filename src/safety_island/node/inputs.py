# SPDX-License-Identifier: Apache-2.0
"""The table of the five inputs: how each is decoded, judged and handed on."""

from __future__ import annotations

import math
from collections.abc import Callable
from operator import attrgetter, itemgetter
from typing import Any, NamedTuple

from safety_island.control.status import Mode, Refusal
from safety_island.dds import topics
from safety_island.dds.topics import TopicEntry
from safety_island.input_gate.content import ContentGate
from safety_island.input_gate.params import GateParams
from safety_island.input_gate.reason import SampleReason
from safety_island.input_gate.stamps import StampGate
from safety_island.messages import inputs as codec
from safety_island.messages.trajectory import Trajectory, decode_trajectory
from safety_island.node.follower import InputFollower


class InputSpec(NamedTuple):
    """One row of the table of inputs."""

    name: str
    """As the follower and the log name it."""
    topic: TopicEntry
    decoder: Callable[[InputFollower], Callable[[bytes], Any]]
    """Makes the function that decodes its samples."""
    check: Callable[[ContentGate, Any, bytes, StampGate], SampleReason | None] | None
    offer: Callable[[InputFollower], Callable[..., Refusal]]
    """Finds the method of the follower that takes the values of a sample."""
    values: Callable[[Any], tuple[Any, ...]]
    """Returns these values of a decoded sample."""
    age_limit_s: Callable[[GateParams], float] = lambda params: math.inf
    age_warning_s: Callable[[GateParams], float] = lambda params: math.inf
    replaced: Callable[[InputFollower], int] | None = None
    """Returns how many values of the sample in force were replaced for contradicting others."""
    gives: Callable[[Any], bool] | None = None
    """For what is sent on change: whether a message gives autonomy."""


def _plain(decode: Callable[[bytes], Any]) -> Callable[[InputFollower], Callable[[bytes], Any]]:
    return lambda follower: decode


def _into_the_follower(follower: InputFollower) -> Callable[[bytes], Trajectory]:
    """Decode points into the follower's own memory; too many are refused before any is copied."""
    return lambda data: decode_trajectory(data, follower.incoming)


def _trajectory_values(message: Trajectory) -> tuple[int, float, float]:
    return len(message.points), message.stamp.seconds, message.first_time.seconds


def _fields(kind: Any, *names: str) -> Callable[[Any], tuple[Any, ...]]:
    """Return a function that gets these fields of a message: in C, for it runs in every tick."""
    places = [kind._fields.index(name) for name in names]
    return itemgetter(*places) if names[1:] else itemgetter(slice(places[0], places[0] + 1))


_AUTONOMOUS = int(Mode.AUTONOMOUS)


def gives_autonomy(state: codec.OperationMode) -> bool:
    """Whether the vehicle is under Autoware's control in this state."""
    return state.mode == _AUTONOMOUS and state.is_autoware_control_enabled


_ODOMETRY = ("x", "y", "z", "qx", "qy", "qz", "qw", "vx", "vy", "wz")
_MODE = ("mode", "is_autoware_control_enabled")

INPUTS = (
    InputSpec(
        "trajectory",
        topics.TRAJECTORY,
        _into_the_follower,
        ContentGate.trajectory,
        attrgetter("offer_incoming"),
        _trajectory_values,
        lambda params: params.trajectory_age_limit,
        replaced=attrgetter("turned_points"),
    ),
    InputSpec(
        "odometry",
        topics.ODOMETRY,
        _plain(codec.decode_odometry),
        ContentGate.odometry,
        attrgetter("offer_odometry"),
        _fields(codec.Odometry, *_ODOMETRY),
        lambda params: params.odometry_age_limit,
        lambda params: params.age_warning,
    ),
    InputSpec(
        "steering",
        topics.STEERING,
        _plain(codec.decode_steering),
        None,
        attrgetter("offer_steering"),
        _fields(codec.Steering, "steering_tire_angle"),
        lambda params: params.steering_age_limit,
        lambda params: params.age_warning,
    ),
    InputSpec(
        "acceleration",
        topics.ACCELERATION,
        _plain(codec.decode_acceleration),
        ContentGate.acceleration,
        attrgetter("offer_acceleration"),
        _fields(codec.Acceleration, "ax"),
        lambda params: params.acceleration_age_limit,
        lambda params: params.age_warning,
    ),
    InputSpec(
        "operation mode",
        topics.OPERATION_MODE,
        _plain(codec.decode_operation_mode),
        None,
        attrgetter("offer_operation_mode"),
        _fields(codec.OperationMode, *_MODE),
        gives=gives_autonomy,
    ),
)
"""The five inputs, in the order in which a tick takes them."""


def inputs_of(release: str) -> tuple[InputSpec, ...]:
    """Return INPUTS with the topics of a release of Autoware."""
    return tuple(spec._replace(topic=spec.topic.of_release(release)) for spec in INPUTS)
