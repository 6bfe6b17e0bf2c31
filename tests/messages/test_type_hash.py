"""Type hashes against rosbags, which computes them from its own definitions."""

from __future__ import annotations

import pytest

from safety_island.messages import registry
from tests.messages.oracle import typestore


@pytest.mark.parametrize("name", registry.names())
def test_hash_equals_that_of_an_independent_implementation(name: str) -> None:
    assert registry.lookup(name).hash == typestore().hash_rihs01(name)


def test_known_hash_of_ros_2_kilted() -> None:
    """Read from rclpy of ROS 2 Kilted."""
    expected = "RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"
    assert registry.lookup("nav_msgs/msg/Odometry").hash == expected
