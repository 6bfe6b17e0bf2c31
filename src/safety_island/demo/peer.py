"""A main compute with the public Python package of CycloneDDS, and nothing of the island's.

Publishes the island's five inputs (a straight road, a vehicle on it, the operation mode) and prints
the commands that come back. Start `island run`, then: python demo/peer.py [DOMAIN [SECONDS]]
"""

import sys
import time

from cyclonedds import idl
from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import types
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
autoware_planning_msgs/Trajectory: Header header, Points points
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
known = {"str": str, "bool": bool, "Covariance": types.array[types.float64, 36], **vars(types)}
for line in MESSAGES.strip().splitlines():
    package, name, fields = line.replace(": ", "/", 1).split("/", 2)
    members = [field.split() for field in fields.split(", ")]
    dds_name = f"{package}::msg::dds_::{name}_"  # how ROS names its types on the wire
    known[name] = idl.make_idl_struct(name, dds_name, {key: known[kind] for kind, key in members})
    known["Points"] = types.sequence[known[name]] if name == "TrajectoryPoint" else None

STOP, AUTONOMOUS, PERIOD_S = 1, 2, 0.025
RELIABLE = Qos(Policy.Reliability.Reliable(10**9), Policy.History.KeepLast(1))
LATCHED = Qos(Policy.Durability.TransientLocal, base=RELIABLE)  # as ROS has the operation mode
participant = DomainParticipant(int(sys.argv[1]) if len(sys.argv) > 1 else 2)


def topic(name, kind):
    """Make the topic of a ROS topic: its name on the wire begins with rt."""
    return Topic(participant, f"rt/{name}", known[kind])


def writer(name, kind, qos=RELIABLE):
    """Make the writer of a ROS topic."""
    return DataWriter(participant, topic(name, kind), qos=qos)


def new(kind, *values):
    """Make a message."""
    return known[kind](*values)


trajectory = writer("planning/scenario_planning/trajectory", "Trajectory")
odometry = writer("localization/kinematic_state", "Odometry")
acceleration = writer("localization/acceleration", "AccelWithCovarianceStamped")
steering = writer("vehicle/status/steering_status", "SteeringReport")
operation_mode = writer("system/operation_mode/state", "OperationModeState", LATCHED)
control_topic = topic("control/trajectory_follower/control_cmd", "Control")
control = DataReader(participant, control_topic, qos=RELIABLE)

x = speed = asked = 0.0
mode, told, end = STOP, None, time.monotonic() + float((sys.argv[2:] or ["inf"])[0])
ahead, zero, unknown = new("Quaternion", 0, 0, 0, 1), new("Vector3", 0, 0, 0), [0.0] * 36
while time.monotonic() < end:
    now = new("Time", *divmod(time.time_ns(), 10**9))
    on_map, on_vehicle = new("Header", now, "map"), new("Header", now, "base_link")
    for command in control.take(10):
        mode, asked = AUTONOMOUS, command.longitudinal.acceleration  # engage when commands come
        angle = command.lateral.steering_tire_angle
        print(f"{angle:+.4f} rad, {asked:+.3f} m/s2, at {speed:.2f} m/s", flush=True)
    places = [new("Pose", new("Vector3", x + 0.5 * i, 0, 0), ahead) for i in range(-20, 200)]
    on_road = [new("TrajectoryPoint", new("Duration", 0, 0), at, 5.0, *[0.0] * 5) for at in places]
    trajectory.write(new("Trajectory", on_map, on_road))
    pose = new("PoseWithCovariance", new("Pose", new("Vector3", x, 0, 0), ahead), unknown)
    motion = new("TwistWithCovariance", new("Twist", new("Vector3", speed, 0, 0), zero), unknown)
    odometry.write(new("Odometry", on_map, "base_link", pose, motion))
    felt = new("AccelWithCovariance", new("Twist", new("Vector3", asked, 0, 0), zero), unknown)
    acceleration.write(new("AccelWithCovarianceStamped", on_vehicle, felt))
    steering.write(new("SteeringReport", now, 0.0))
    if mode != told:
        told = mode
        engaged = mode == AUTONOMOUS
        operation_mode.write(new("OperationModeState", now, mode, engaged, *[False] * 5))
    speed = max(0.0, speed + asked * PERIOD_S)
    x += speed * PERIOD_S
    time.sleep(PERIOD_S)
