# SPDX-License-Identifier: Apache-2.0
"""The registry holds exactly the types of the island's edge, with their ROS and DDS names."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from rosbags.typesys import get_types_from_idl

import safety_island.messages
from safety_island.messages import registry
from safety_island.messages.errors import UnknownTypeError

IDL = Path(safety_island.messages.__file__).parent / "idl"
FIELDS = {
    "autoware_adapi_v1_msgs/msg/OperationModeState": "stamp mode is_autoware_control_enabled"
    " is_in_transition is_stop_mode_available is_autonomous_mode_available"
    " is_local_mode_available is_remote_mode_available",
    "autoware_control_msgs/msg/Control": "stamp control_time lateral longitudinal",
    "autoware_control_msgs/msg/ControlHorizon": "stamp control_time time_step_ms controls",
    "autoware_control_msgs/msg/Lateral": "stamp control_time steering_tire_angle"
    " steering_tire_rotation_rate is_defined_steering_tire_rotation_rate",
    "autoware_control_msgs/msg/Longitudinal": "stamp control_time velocity acceleration jerk"
    " is_defined_acceleration is_defined_jerk",
    "autoware_internal_debug_msgs/msg/Float32MultiArrayStamped": "stamp data",
    "autoware_internal_debug_msgs/msg/Float32Stamped": "stamp data",
    "autoware_internal_debug_msgs/msg/Float64Stamped": "stamp data",
    "autoware_planning_msgs/msg/Trajectory": "header points",
    "autoware_planning_msgs/msg/TrajectoryPoint": "time_from_start pose longitudinal_velocity_mps"
    " lateral_velocity_mps acceleration_mps2 heading_rate_rps front_wheel_angle_rad"
    " rear_wheel_angle_rad",
    "autoware_vehicle_msgs/msg/SteeringReport": "stamp steering_tire_angle",
    "builtin_interfaces/msg/Duration": "sec nanosec",
    "builtin_interfaces/msg/Time": "sec nanosec",
    "diagnostic_msgs/msg/DiagnosticArray": "header status",
    "diagnostic_msgs/msg/DiagnosticStatus": "level name message hardware_id values",
    "diagnostic_msgs/msg/KeyValue": "key value",
    "geometry_msgs/msg/Accel": "linear angular",
    "geometry_msgs/msg/AccelWithCovariance": "accel covariance",
    "geometry_msgs/msg/AccelWithCovarianceStamped": "header accel",
    "geometry_msgs/msg/Point": "x y z",
    "geometry_msgs/msg/Pose": "position orientation",
    "geometry_msgs/msg/PoseWithCovariance": "pose covariance",
    "geometry_msgs/msg/Quaternion": "x y z w",
    "geometry_msgs/msg/Twist": "linear angular",
    "geometry_msgs/msg/TwistWithCovariance": "twist covariance",
    "geometry_msgs/msg/Vector3": "x y z",
    "nav_msgs/msg/Odometry": "header child_frame_id pose twist",
    "rmw_dds_common/msg/Gid": "data",
    "rmw_dds_common/msg/NodeEntitiesInfo": "node_namespace node_name reader_gid_seq writer_gid_seq",
    "rmw_dds_common/msg/ParticipantEntitiesInfo": "gid node_entities_info_seq",
    "safety_island_msgs/msg/Arm": "stamp nonce",
    "safety_island_msgs/msg/InputStatus": "refused writer_guid sample_stamp source_time"
    " accepted received superseded refused_in_a_row age age_limit transport_delay warnings"
    " last_refusal other_writers",
    "safety_island_msgs/msg/Status": "stamp now arm_nonce tick commands memory foreign_can_frames"
    " parameters_hash snapshot_layout"
    " lateral_error yaw_error residual stop_dist target_vel command_angle command_rate"
    " command_velocity command_acceleration"
    " tick_time lateral_time longitudinal_time lateness missed_periods"
    " missed_periods_total overruns controller_limits guard_limits guard_clamped"
    " guard_refused sequence output_failures solver_status solver_iterations"
    " active_constraints state reason subject latched_cause operation_mode"
    " longitudinal_state mpc_status guard_verdict output_mode arm_result"
    " other_control_writers degraded armed engaged control_enabled published inputs",
    "std_msgs/msg/Header": "stamp frame_id",
    "tier4_debug_msgs/msg/Float32MultiArrayStamped": "stamp data",
    "tier4_debug_msgs/msg/Float32Stamped": "stamp data",
    "tier4_debug_msgs/msg/Float64Stamped": "stamp data",
}


def test_exactly_the_types_of_the_edge_with_their_fields_in_order() -> None:
    found = {n: " ".join(f.name for f in registry.struct_of(n).fields) for n in registry.names()}
    assert found == FIELDS


@pytest.mark.parametrize("name", registry.names())
def test_another_idl_parser_reads_the_same_fields(name: str) -> None:
    package, _, short = name.split("/")
    text = (IDL / package / "msg" / f"{short}.idl").read_text(encoding="utf-8")
    text = re.sub(r"^(#include|//).*$", "", text, flags=re.MULTILINE)
    constants, fields = get_types_from_idl(text)[name]
    assert [field_name for field_name, _ in fields] == FIELDS[name].split()
    ours = registry.struct_of(name).constants
    assert {constant: value for constant, _, value in constants} == dict(ours)


def test_includes_name_the_types_that_are_used() -> None:
    for path in IDL.rglob("*.idl"):
        text = path.read_text(encoding="utf-8")
        used = {f"{p}/msg/{n}.idl" for p, n in re.findall(r"(\w+)::msg::(\w+)", text)}
        assert set(re.findall(r'#include "(.*)"', text)) == used, path


def test_names_on_the_wire() -> None:
    entry = registry.lookup("nav_msgs/msg/Odometry")
    assert entry.dds_name == "nav_msgs::msg::dds_::Odometry_"
    assert registry.ros_type_name(entry.dds_name) == "nav_msgs/msg/Odometry"
    assert registry.ros_type_name("HelloWorld") == "HelloWorld"
    assert registry.known("nav_msgs/msg/Odometry")
    assert not registry.known("nav_msgs/msg/Path")


def test_operation_mode_constants() -> None:
    struct = registry.struct_of("autoware_adapi_v1_msgs/msg/OperationModeState")
    modes = {"UNKNOWN": 0, "STOP": 1, "AUTONOMOUS": 2, "LOCAL": 3, "REMOTE": 4}
    assert dict(struct.constants) == modes


def test_quaternion_defaults() -> None:
    fields = registry.struct_of("geometry_msgs/msg/Quaternion").fields
    assert [field.default for field in fields] == [0.0, 0.0, 0.0, 1.0]


def test_an_unknown_type_is_told_with_the_nearest_name() -> None:
    with pytest.raises(UnknownTypeError, match="did you mean 'nav_msgs/msg/Odometry'"):
        registry.lookup("nav_msgs/msg/Odometrie")
    with pytest.raises(UnknownTypeError, match="not of the form package/msg/Name"):
        registry.dds_type_name("Odometry")


def test_inner_structs_are_found_at_any_depth() -> None:
    inner = [s.name for s in registry.inner_structs("geometry_msgs/msg/PoseWithCovariance")]
    assert inner == [f"geometry_msgs/msg/{name}" for name in ("Point", "Pose", "Quaternion")]
