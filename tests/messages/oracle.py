# SPDX-License-Identifier: Apache-2.0
"""Two serializers that are not ours: rosbags (types from .msg texts) and cyclonedds."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from safety_island import messages
from safety_island.messages import registry
from safety_island.messages.description import Array, Element, FieldType, Named, Primitive, Sequence
from tests.messages.cyclone_types import cyclone_type

MSG_TEXTS = {
    "autoware_control_msgs/msg/Lateral": """
        builtin_interfaces/Time stamp
        builtin_interfaces/Time control_time
        float32 steering_tire_angle
        float32 steering_tire_rotation_rate
        bool is_defined_steering_tire_rotation_rate""",
    "autoware_control_msgs/msg/Longitudinal": """
        builtin_interfaces/Time stamp
        builtin_interfaces/Time control_time
        float32 velocity
        float32 acceleration
        float32 jerk
        bool is_defined_acceleration
        bool is_defined_jerk""",
    "autoware_control_msgs/msg/Control": """
        builtin_interfaces/Time stamp
        builtin_interfaces/Time control_time
        autoware_control_msgs/Lateral lateral
        autoware_control_msgs/Longitudinal longitudinal""",
    "autoware_planning_msgs/msg/TrajectoryPoint": """
        builtin_interfaces/Duration time_from_start
        geometry_msgs/Pose pose
        float32 longitudinal_velocity_mps
        float32 lateral_velocity_mps
        float32 acceleration_mps2
        float32 heading_rate_rps
        float32 front_wheel_angle_rad
        float32 rear_wheel_angle_rad""",
    "autoware_planning_msgs/msg/Trajectory": """
        std_msgs/Header header
        autoware_planning_msgs/TrajectoryPoint[] points""",
    "autoware_vehicle_msgs/msg/SteeringReport": """
        builtin_interfaces/Time stamp
        float32 steering_tire_angle""",
    "autoware_adapi_v1_msgs/msg/OperationModeState": """
        uint8 UNKNOWN = 0
        uint8 STOP = 1
        uint8 AUTONOMOUS = 2
        uint8 LOCAL = 3
        uint8 REMOTE = 4
        builtin_interfaces/Time stamp
        uint8 mode
        bool is_autoware_control_enabled
        bool is_in_transition
        bool is_stop_mode_available
        bool is_autonomous_mode_available
        bool is_local_mode_available
        bool is_remote_mode_available""",
    **{
        f"{package}/msg/{name}": f"""
        builtin_interfaces/Time stamp
        {field}"""
        for package in ("tier4_debug_msgs", "autoware_internal_debug_msgs")
        for name, field in (
            ("Float32Stamped", "float32 data"),
            ("Float32MultiArrayStamped", "float32[] data"),
            ("Float64Stamped", "float64 data"),
        )
    },
    "autoware_control_msgs/msg/ControlHorizon": """
        builtin_interfaces/Time stamp
        builtin_interfaces/Time control_time
        float32 time_step_ms
        autoware_control_msgs/Control[] controls""",
    "rmw_dds_common/msg/Gid": "uint8[16] data",
}
"""As the public packages define them, written from spec and packages, not from our IDL files."""
OWN_MSG_FILES = Path(messages.__file__).parent / "msg" / "safety_island_msgs" / "msg"


@cache
def typestore() -> Any:
    """Return a rosbags type store that knows every type of the island."""
    store = get_typestore(Stores.ROS2_KILTED)
    store.fielddefs.pop("rmw_dds_common/msg/Gid")
    for name, text in MSG_TEXTS.items():
        lines = "\n".join(line.strip() for line in text.splitlines())
        store.register(get_types_from_msg(lines, name))
    for path in sorted(OWN_MSG_FILES.glob("*.msg")):
        store.register(get_types_from_msg(path.read_text(), f"safety_island_msgs/msg/{path.stem}"))
    return store


def rosbags_bytes(name: str, message: dict[str, Any], little_endian: bool = True) -> bytes:
    """Serialize with rosbags."""
    made = _rosbags_object(name, message)
    return bytes(typestore().serialize_cdr(made, name, little_endian=little_endian))


def cyclone_bytes(name: str, message: dict[str, Any]) -> bytes:
    """Serialize with the types that cyclonedds builds from our IDL."""
    data: bytes = _cyclone_object(name, message).serialize()
    return data


def _rosbags_object(name: str, message: dict[str, Any]) -> Any:
    values = {
        field.name: _map(field.type, message[field.name], _rosbags_object, True)
        for field in registry.struct_of(name).fields
    }
    return typestore().types[name](**values)


def _cyclone_object(name: str, message: dict[str, Any]) -> Any:
    values = {
        field.name: _map(field.type, message[field.name], _cyclone_object, False)
        for field in registry.struct_of(name).fields
    }
    return cyclone_type(name)(**values)


def _map(kind: FieldType, value: Any, make: Any, arrays: bool) -> Any:
    if isinstance(kind, (Array, Sequence)):
        if isinstance(kind.element, Named):
            return [make(kind.element.name, item) for item in value]
        return np.array(value, _DTYPES[kind.element]) if arrays else list(value)
    if kind is Primitive.OCTET and arrays and value > 127:
        return value - 256  # rosbags reads a byte as a signed number
    return make(kind.name, value) if isinstance(kind, Named) else value


_DTYPES: dict[Element, str] = {
    Primitive.DOUBLE: "f8",
    Primitive.FLOAT: "f4",
    Primitive.UINT8: "u1",
    Primitive.UINT32: "u4",
}
