# SPDX-License-Identifier: Apache-2.0
"""A main compute with the public Python package of CycloneDDS, and nothing of the island's.

Publishes the island's five inputs (a straight road, a vehicle on it, the operation mode) and prints
the commands that come back. Start `island run`, then: python demo/peer.py [DOMAIN [SECONDS]]
Where it does not find the island: eval "$(island env --for cyclonedds)" first.
"""

import sys
import time
from typing import Any

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import make_idl_struct, types
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic

MESSAGES = """
builtin_interfaces/Time: int32 sec, uint32 nanosec
builtin_interfaces/Duration: int32 sec, uint32 nanosec
std_msgs/Header: Time stamp, str frame_id
geometry_msgs/Vector3: float64 x, float64 y, float64 z
geometry_msgs/Quaternion: float64 x, float64 y, float64 z, float64 w
geometry_msgs/Pose: Vector3 position, Quaternion orientation
geometry_msgs/Twist: Vector3 linear, Vector3 angular
geometry_msgs/PoseWithCovariance: Pose pose, Covariance covariance
geometry_msgs/TwistWithCovariance: Twist twist, Covariance covariance
geometry_msgs/AccelWithCovariance: Twist accel, Covariance covariance
geometry_msgs/AccelWithCovarianceStamped: Header header, AccelWithCovariance accel
nav_msgs/Odometry: Header header, str child_frame_id, PoseWithCovariance pose, \
TwistWithCovariance twist
autoware_planning_msgs/TrajectoryPoint: Duration time_from_start, Pose pose, \
float32 longitudinal_velocity_mps, float32 lateral_velocity_mps, float32 acceleration_mps2, \
float32 heading_rate_rps, float32 front_wheel_angle_rad, float32 rear_wheel_angle_rad
autoware_planning_msgs/Trajectory: Header header, TrajectoryPoint[] points
autoware_vehicle_msgs/SteeringReport: Time stamp, float32 steering_tire_angle
autoware_adapi_v1_msgs/OperationModeState: Time stamp, uint8 mode, \
bool is_autoware_control_enabled, bool is_in_transition, bool is_stop_mode_available, \
bool is_autonomous_mode_available, bool is_local_mode_available, bool is_remote_mode_available
autoware_control_msgs/Lateral: Time stamp, Time control_time, float32 steering_tire_angle, \
float32 steering_tire_rotation_rate, bool is_defined_steering_tire_rotation_rate
autoware_control_msgs/Longitudinal: Time stamp, Time control_time, float32 velocity, \
float32 acceleration, float32 jerk, bool is_defined_acceleration, bool is_defined_jerk
autoware_control_msgs/Control: Time stamp, Time control_time, Lateral lateral, \
Longitudinal longitudinal
"""
idl: Any = types  # its generic types are made at run time
known: dict[str, Any] = {
    "str": str, "bool": bool, "Covariance": idl.array[idl.float64, 36], **vars(idl),
}  # fmt: skip
for line in MESSAGES.strip().splitlines():
    name, fields = line.split(": ")
    members = {key: known[kind] for kind, key in map(str.split, fields.split(", "))}
    package, name = name.split("/")
    on_wire = f"{package}::msg::dds_::{name}_"  # the DDS name of a ROS type
    known[name] = make_idl_struct(name, on_wire, members)
    known.setdefault(f"{name}[]", idl.sequence[known[name]])

RELIABLE = Qos(Policy.Reliability.Reliable(10**9), Policy.History.KeepLast(1))
LATCHED = Qos(Policy.Durability.TransientLocal, base=RELIABLE)  # for who comes later
participant = DomainParticipant(int(sys.argv[1]) if len(sys.argv) > 1 else 2)


def topic(name: str, kind: str) -> Topic[Any]:
    """Return the DDS topic of a ROS topic."""
    return Topic(participant, f"rt/{name}", known[kind])


def writer(name: str, kind: str, qos: Qos = RELIABLE) -> DataWriter[Any]:
    """Return the writer of a ROS topic."""
    return DataWriter(participant, topic(name, kind), qos=qos)


def new(kind: str, *values: Any) -> Any:
    """Return a message."""
    return known[kind](*values)


trajectory = writer("planning/scenario_planning/trajectory", "Trajectory")
odometry = writer("localization/kinematic_state", "Odometry")
acceleration = writer("localization/acceleration", "AccelWithCovarianceStamped")
steering = writer("vehicle/status/steering_status", "SteeringReport")
mode = writer("system/operation_mode/state", "OperationModeState", LATCHED)
commands = DataReader(
    participant, topic("control/trajectory_follower/control_cmd", "Control"), qos=RELIABLE
)

STOP, AUTONOMOUS, PERIOD_S = 1, 2, 0.025
zero, unknown, ahead = new("Vector3", 0, 0, 0), [0.0] * 36, new("Quaternion", 0, 0, 0, 1)
x = speed = asked = 0.0
wanted, published, rounds = STOP, 0, 0
began = time.monotonic()
while (due := rounds * PERIOD_S) < float((sys.argv[2:] or ["inf"])[0]):
    time.sleep(max(0.0, began + due - time.monotonic()))
    now = new("Time", *divmod(time.time_ns(), 10**9))
    on_map, on_vehicle = new("Header", now, "map"), new("Header", now, "base_link")
    for command in commands.take(10):
        wanted, asked = AUTONOMOUS, command.longitudinal.acceleration  # engage: commands come
        angle = command.lateral.steering_tire_angle
        print(f"{angle:+.4f} rad, {asked:+.3f} m/s2, at {speed:.2f} m/s", flush=True)
    if rounds % 4 == 0:  # 5 m/s on a straight road, from 10 m behind to 90 m ahead
        places = [new("Pose", new("Vector3", x + s, 0, 0), ahead) for s in range(-10, 91)]
        start = new("Duration", 0, 0)
        points = [new("TrajectoryPoint", start, at, 5.0, *[0.0] * 5) for at in places]
        trajectory.write(new("Trajectory", on_map, points))
    pose = new("PoseWithCovariance", new("Pose", new("Vector3", x, 0, 0), ahead), unknown)
    motion = new("TwistWithCovariance", new("Twist", new("Vector3", speed, 0, 0), zero), unknown)
    odometry.write(new("Odometry", on_map, "base_link", pose, motion))
    felt = new("Twist", new("Vector3", asked if speed else 0.0, 0, 0), zero)
    measured = new("AccelWithCovariance", felt, unknown)
    acceleration.write(new("AccelWithCovarianceStamped", on_vehicle, measured))
    steering.write(new("SteeringReport", now, 0.0))
    if wanted != published:
        mode.write(new("OperationModeState", now, wanted, wanted == AUTONOMOUS, *[False] * 5))
        published = wanted
    speed = max(0.0, speed + asked * PERIOD_S)
    x, rounds = x + speed * PERIOD_S, rounds + 1
