# SPDX-License-Identifier: Apache-2.0
"""ROS 2 Kilted on the main compute's domain, the island on its own, our bridge between them."""

from __future__ import annotations

from pathlib import Path

from tests.interop.conftest import RosNode
from tests.interop.namespace import Namespace
from tests.interop.test_rclpy import event

MAIN_COMPUTE, ISLAND = 1, 2

BRIDGE_FILE = """
name: interop_bridge
from_domain: 1
to_domain: 2
topics:
  localization/kinematic_state: {type: nav_msgs/msg/Odometry}
  localization/acceleration: {type: geometry_msgs/msg/AccelWithCovarianceStamped}
  echo/odometry: {type: nav_msgs/msg/Odometry, reversed: true}
  echo/acceleration: {type: geometry_msgs/msg/AccelWithCovarianceStamped, reversed: true}
  echo/state: {type: nav_msgs/msg/Odometry, reversed: true}
"""


def test_messages_cross_the_bridge_both_ways(
    namespace: Namespace, ros_node: RosNode, tmp_path: Path
) -> None:
    """What rclpy publishes reaches the island, and the island's answers reach rclpy."""
    config = tmp_path / "bridge.yaml"
    config.write_text(BRIDGE_FILE)
    namespace.island("safety_island", "bridge", str(config))
    island = namespace.island("tests.interop.island_peer", str(ISLAND))
    ros = ros_node(MAIN_COMPUTE)
    received = island.expect(event("odometry"))
    assert received["x"] == -received["wz"] > 0
    back = ros.expect(event("odometry"))
    assert (back["x"], back["cov"]) == (back["wz"], 0.75)
    assert back["frames"] == ["map", "base_link"]
    assert ros.expect(event("acceleration"))["ax"] < 0


def test_a_late_ros_node_receives_the_latched_state_through_the_bridge(
    namespace: Namespace, ros_node: RosNode, tmp_path: Path
) -> None:
    config = tmp_path / "bridge.yaml"
    config.write_text(BRIDGE_FILE)
    namespace.island("tests.interop.island_peer", str(ISLAND))
    namespace.island("safety_island", "bridge", str(config))
    assert ros_node(MAIN_COMPUTE).expect(event("state"))["x"] == 42.0
