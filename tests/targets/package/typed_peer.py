# SPDX-License-Identifier: Apache-2.0
"""A peer that is not ours: typed CycloneDDS, with message classes written out by hand.

``python typed_peer.py listen DOMAIN`` prints what it reads of two inputs of the island;
``python typed_peer.py speak DOMAIN`` publishes control commands until it is ended. Each says
"ready" first. Annotations are types here, not text: CycloneDDS looks at them.
"""

import sys
import time
from dataclasses import dataclass
from typing import Any

from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import float32, float64, int32, sequence, uint32
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

LOOPBACK = """<CycloneDDS><Domain Id="any"><General><Interfaces><NetworkInterface name="lo"/>
</Interfaces><AllowMulticast>false</AllowMulticast></General><Discovery>
<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>99</MaxAutoParticipantIndex>
</Discovery></Domain></CycloneDDS>"""


@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: int32
    nanosec: uint32


@dataclass
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time
    frame_id: str


@dataclass
class SteeringReport(IdlStruct, typename="autoware_vehicle_msgs::msg::dds_::SteeringReport_"):
    stamp: Time
    steering_tire_angle: float32


@dataclass
class Duration(IdlStruct, typename="builtin_interfaces::msg::dds_::Duration_"):
    sec: int32
    nanosec: uint32


@dataclass
class Point(IdlStruct, typename="geometry_msgs::msg::dds_::Point_"):
    x: float64
    y: float64
    z: float64


@dataclass
class Quaternion(IdlStruct, typename="geometry_msgs::msg::dds_::Quaternion_"):
    x: float64
    y: float64
    z: float64
    w: float64


@dataclass
class Pose(IdlStruct, typename="geometry_msgs::msg::dds_::Pose_"):
    position: Point
    orientation: Quaternion


@dataclass
class TrajectoryPoint(IdlStruct, typename="autoware_planning_msgs::msg::dds_::TrajectoryPoint_"):
    time_from_start: Duration
    pose: Pose
    longitudinal_velocity_mps: float32
    lateral_velocity_mps: float32
    acceleration_mps2: float32
    heading_rate_rps: float32
    front_wheel_angle_rad: float32
    rear_wheel_angle_rad: float32


@dataclass
class Trajectory(IdlStruct, typename="autoware_planning_msgs::msg::dds_::Trajectory_"):
    header: Header
    points: sequence[TrajectoryPoint]  # type: ignore[type-arg]


@dataclass
class Lateral(IdlStruct, typename="autoware_control_msgs::msg::dds_::Lateral_"):
    stamp: Time
    control_time: Time
    steering_tire_angle: float32
    steering_tire_rotation_rate: float32
    is_defined_steering_tire_rotation_rate: bool


@dataclass
class Longitudinal(IdlStruct, typename="autoware_control_msgs::msg::dds_::Longitudinal_"):
    stamp: Time
    control_time: Time
    velocity: float32
    acceleration: float32
    jerk: float32
    is_defined_acceleration: bool
    is_defined_jerk: bool


@dataclass
class Control(IdlStruct, typename="autoware_control_msgs::msg::dds_::Control_"):
    stamp: Time
    control_time: Time
    lateral: Lateral
    longitudinal: Longitudinal


def listen(participant: DomainParticipant) -> None:
    """Print the first steering report and the first trajectory."""
    steering: Any = DataReader(
        participant, Topic(participant, "rt/vehicle/status/steering_status", SteeringReport)
    )
    trajectory: Any = DataReader(
        participant, Topic(participant, "rt/planning/scenario_planning/trajectory", Trajectory)
    )
    print("ready", flush=True)
    report = next(steering.take_iter(timeout=duration(seconds=60)))
    path = next(trajectory.take_iter(timeout=duration(seconds=60)))
    speed = path.points[-1].longitudinal_velocity_mps
    print(f"{report.steering_tire_angle} {path.header.frame_id} {len(path.points)} {speed}")


def speak(participant: DomainParticipant) -> None:
    """Publish control commands with numbers that can be told again."""
    qos = Qos(
        Policy.Reliability.Reliable(duration(milliseconds=100)),
        Policy.Durability.TransientLocal,
        Policy.History.KeepLast(1),
    )
    name = "rt/control/trajectory_follower/control_cmd"
    writer: Any = DataWriter(participant, Topic(participant, name, Control), qos=qos)
    now = Time(7, 8)
    lateral = Lateral(now, Time(0, 0), 0.25, -0.5, True)
    command = Control(
        now, Time(0, 0), lateral, Longitudinal(now, now, 12.25, -1.5, 0.0, True, False)
    )
    print("ready", flush=True)
    while True:
        writer.write(command)
        time.sleep(0.05)


if __name__ == "__main__":
    domain = Domain(int(sys.argv[2]), LOOPBACK)
    {"listen": listen, "speak": speak}[sys.argv[1]](DomainParticipant(int(sys.argv[2])))
