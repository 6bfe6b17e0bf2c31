"""The table of the five inputs: how each is decoded, judged and handed on."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from safety_island.control.status import Refusal
from safety_island.dds import topics
from safety_island.dds.topics import TopicEntry
from safety_island.gate.content import ContentGate
from safety_island.gate.params import GateParams
from safety_island.gate.reason import SampleReason
from safety_island.gate.stamps import StampGate
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
    return follower.offer_odometry(*message[3:12], message[15])  # neither vz, wx nor wy


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
