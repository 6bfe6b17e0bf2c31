# SPDX-License-Identifier: Apache-2.0
"""The one table of the island's topics: subscriptions, age limits, bridge file and docs use it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import StrEnum

from safety_island.control.release import RELEASES
from safety_island.dds.qos import DEFAULT, INPUT_DEPTH, LATCHED, Qos

MAIN_COMPUTE_DOMAIN = 1
SAFETY_ISLAND_DOMAIN = 2


class Direction(StrEnum):
    """Seen from the island."""

    IN = "in"
    OUT = "out"


@dataclass(frozen=True)
class TopicEntry:
    """One topic of the island.

    ``key`` is its short name in code and reports; ``rate_hz`` [Hz] is the expected rate, None when
    it is sent on change, 0 for once a tick; ``age_limit`` is the parameter that bounds its age,
    empty for no bound; ``bridged`` is (from domain, to domain).
    """

    key: str
    name: str
    type_name: str
    direction: Direction
    qos: Qos
    rate_hz: float | None
    age_limit: str = ""
    bridged: tuple[int, int] | None = None

    newer: tuple[tuple[str, str, str], ...] = ()
    """Release from which on the topic has another name and type, with both; oldest first."""

    def of_release(self, release: str) -> TopicEntry:
        """Return the entry as a release of Autoware has it."""
        entry = self
        for since, name, type_name in self.newer:
            if RELEASES.index(release) >= RELEASES.index(since):
                entry = replace(entry, name=name, type_name=type_name)
        return entry

    @property
    def subscription_qos(self) -> Qos:
        """What the island subscribes with: as published, with room to count what it drops."""
        return self.qos.with_depth(INPUT_DEPTH)


EVERY_TICK = 0.0
_INWARD = (MAIN_COMPUTE_DOMAIN, SAFETY_ISLAND_DOMAIN)
_OUTWARD = (SAFETY_ISLAND_DOMAIN, MAIN_COMPUTE_DOMAIN)
_FAST_RATE = 35.6

STEERING = TopicEntry(
    "steering",
    "/vehicle/status/steering_status",
    "autoware_vehicle_msgs/msg/SteeringReport",
    Direction.IN,
    DEFAULT,
    _FAST_RATE,
    "gate.age_limit.steering",
    _INWARD,
)
TRAJECTORY = TopicEntry(
    "trajectory",
    "/planning/scenario_planning/trajectory",
    "autoware_planning_msgs/msg/Trajectory",
    Direction.IN,
    DEFAULT,
    7.4,
    "gate.age_limit.trajectory",
    _INWARD,
    (("0.47", "/planning/trajectory", "autoware_planning_msgs/msg/Trajectory"),),
)
ODOMETRY = TopicEntry(
    "odometry",
    "/localization/kinematic_state",
    "nav_msgs/msg/Odometry",
    Direction.IN,
    DEFAULT,
    _FAST_RATE,
    "gate.age_limit.odometry",
    _INWARD,
)
ACCELERATION = TopicEntry(
    "acceleration",
    "/localization/acceleration",
    "geometry_msgs/msg/AccelWithCovarianceStamped",
    Direction.IN,
    DEFAULT,
    _FAST_RATE,
    "gate.age_limit.acceleration",
    _INWARD,
)
OPERATION_MODE = TopicEntry(
    "operation_mode",
    "/system/operation_mode/state",
    "autoware_adapi_v1_msgs/msg/OperationModeState",
    Direction.IN,
    LATCHED,
    None,
    bridged=_INWARD,
)
CONTROL = TopicEntry(
    "control",
    "/control/trajectory_follower/control_cmd",
    "autoware_control_msgs/msg/Control",
    Direction.OUT,
    LATCHED,
    EVERY_TICK,
    bridged=_OUTWARD,
)
LATERAL_TIME = TopicEntry(
    "lateral_processing_time",
    "/control/trajectory_follower/lateral/debug/processing_time_ms",
    "tier4_debug_msgs/msg/Float64Stamped",
    Direction.OUT,
    DEFAULT,
    EVERY_TICK,
    newer=(
        (
            "0.41",
            "/control/trajectory_follower/lateral/debug/processing_time_ms",
            "autoware_internal_debug_msgs/msg/Float64Stamped",
        ),
    ),
)
LONGITUDINAL_TIME = TopicEntry(
    "longitudinal_processing_time",
    "/control/trajectory_follower/longitudinal/debug/processing_time_ms",
    "tier4_debug_msgs/msg/Float64Stamped",
    Direction.OUT,
    DEFAULT,
    EVERY_TICK,
    newer=(
        (
            "0.41",
            "/control/trajectory_follower/longitudinal/debug/processing_time_ms",
            "autoware_internal_debug_msgs/msg/Float64Stamped",
        ),
    ),
)
STATUS = TopicEntry(
    "status",
    "/safety_island/status",
    "safety_island_msgs/msg/Status",
    Direction.OUT,
    DEFAULT,
    EVERY_TICK,
)
STEERING_OFFSET = TopicEntry(
    "steering_offset",
    "/vehicle/calibration/steer_offset_estimator/steering_offset_update",
    "autoware_internal_debug_msgs/msg/Float32Stamped",
    Direction.IN,
    LATCHED,
    None,
    bridged=_INWARD,
)
"""Optional, and only since 0.51: the offset of the steering sensor [rad]."""
ARM = TopicEntry(
    "arm",
    "/safety_island/arm",
    "safety_island_msgs/msg/Arm",
    Direction.IN,
    DEFAULT,
    None,
)


def _debug(key: str, name: str, type_name: str) -> TopicEntry:
    """Return a debug topic; its type was one of tier4_debug_msgs until 0.40."""
    name = f"/control/trajectory_follower/{name}"
    before = type_name.replace("autoware_internal_debug_msgs", "tier4_debug_msgs")
    newer = () if before == type_name else (("0.41", name, type_name),)
    return TopicEntry(key, name, before, Direction.OUT, DEFAULT, EVERY_TICK, newer=newer)


_NUMBERS = "autoware_internal_debug_msgs/msg/Float32MultiArrayStamped"
CONTROL_HORIZON = _debug(
    "control_horizon",
    "controller_node_exe/debug/control_cmd_horizon",
    "autoware_control_msgs/msg/ControlHorizon",
)
PREDICTED_TRAJECTORY = _debug(
    "predicted_trajectory",
    "lateral/predicted_trajectory",
    "autoware_planning_msgs/msg/Trajectory",
)
LATERAL_DIAGNOSTIC = _debug("lateral_diagnostic", "lateral/diagnostic", _NUMBERS)
LONGITUDINAL_DIAGNOSTIC = _debug("longitudinal_diagnostic", "longitudinal/diagnostic", _NUMBERS)
SLOPE_ANGLE = _debug("slope_angle", "longitudinal/slope_angle", _NUMBERS)
ESTIMATED_OFFSET = _debug(
    "estimated_steer_offset",
    "controller_node_exe/output/estimated_steer_offset",
    "autoware_internal_debug_msgs/msg/Float32Stamped",
)
DIAGNOSTICS = TopicEntry(
    "diagnostics",
    "/diagnostics",
    "diagnostic_msgs/msg/DiagnosticArray",
    Direction.OUT,
    DEFAULT,
    EVERY_TICK,
)

TOPICS = (
    STEERING,
    TRAJECTORY,
    ODOMETRY,
    ACCELERATION,
    OPERATION_MODE,
    CONTROL,
    LATERAL_TIME,
    LONGITUDINAL_TIME,
)
"""In the order of section 2 of the contract."""
INPUTS = tuple(entry for entry in TOPICS if entry.direction is Direction.IN)
OUTPUTS = tuple(entry for entry in TOPICS if entry.direction is Direction.OUT)
BRIDGED = tuple(entry for entry in TOPICS if entry.bridged is not None)
OWN = (STATUS, ARM)
"""The island's own, beyond the contract, on its own domain."""
DEBUG = (
    CONTROL_HORIZON,
    PREDICTED_TRAJECTORY,
    LATERAL_DIAGNOSTIC,
    LONGITUDINAL_DIAGNOSTIC,
    SLOPE_ANGLE,
    ESTIMATED_OFFSET,
    DIAGNOSTICS,
)
"""What Autoware's own tools and RViz look at; published only when asked for."""


def of_release(entries: Iterable[TopicEntry], release: str) -> tuple[TopicEntry, ...]:
    """Return entries as a release of Autoware has them."""
    return tuple(entry.of_release(release) for entry in entries)


def topic(key: str) -> TopicEntry:
    """Return the entry of a short name; KeyError when the table has none."""
    return {entry.key: entry for entry in (*TOPICS, *OWN)}[key]
