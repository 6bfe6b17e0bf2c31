# SPDX-License-Identifier: Apache-2.0
"""ROS 2 Kilted (rclpy, Fast DDS) and the island, face to face on one domain."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

from safety_island.messages import registry
from tests.interop.conftest import RosNode
from tests.interop.namespace import Namespace

DOMAIN = 1
KINEMATIC_STATE = "/localization/kinematic_state"
ODOMETRY = "nav_msgs/msg/Odometry"


def event(name: str, condition: Callable[[Any], bool] = lambda _: True) -> Callable[[str], Any]:
    """Return a check for a JSON line: an event of this name that fulfils the condition."""

    def check(line: str) -> Any:
        if not line.startswith("{"):
            return None
        found = json.loads(line)
        return found if found["event"] == name and condition(found) else None

    return check


def test_messages_go_both_ways(namespace: Namespace, ros_node: RosNode) -> None:
    """What ROS publishes is decoded by the island; what the island encodes is read by ROS."""
    ros = ros_node(DOMAIN)
    island = namespace.island("tests.interop.island_peer", str(DOMAIN))
    received = island.expect(event("odometry"))
    assert received["x"] == -received["wz"] > 0
    back = ros.expect(event("odometry"))
    assert (back["x"], back["cov"]) == (back["wz"], 0.75)
    assert back["frames"] == ["map", "base_link"]
    acceleration = ros.expect(event("acceleration"))
    assert acceleration["ax"] < 0 and acceleration["frame"] == "/base_link"


def test_a_late_ros_node_receives_the_latched_state(
    namespace: Namespace, ros_node: RosNode
) -> None:
    island = namespace.island("tests.interop.island_peer", str(DOMAIN))
    ros = ros_node(DOMAIN)
    assert ros.expect(event("state"))["x"] == 42.0
    island.close()


def test_ros_sees_the_island_as_a_node(namespace: Namespace, ros_node: RosNode) -> None:
    """What ``ros2 node list``, ``ros2 node info`` and ``ros2 topic info`` are made of."""
    ros = ros_node(DOMAIN)
    island = namespace.island("tests.interop.island_peer", str(DOMAIN))
    own = [ODOMETRY, registry.lookup(ODOMETRY).hash]

    def complete(graph: Any) -> bool:
        echo, odometry = (graph["topics"][t] for t in ("/echo/odometry", KINEMATIC_STATE))
        return (
            graph["nodes"] == ["ros_peer", "safety_island"]
            and len(graph["publishes"]) == 3
            and len(graph["subscribes"]) == 2
            and echo["publishers"] == [own]
            and odometry["subscriptions"] == [own]
        )

    graph = ros.expect(event("graph", complete))
    for topic, hashed in graph["hashes"].items():
        for type_name, type_hash in hashed:
            assert type_hash == registry.lookup(type_name).hash, topic
    assert len(graph["hashes"]) == 3 and all(graph["hashes"].values())
    assert ["/echo/odometry", [ODOMETRY]] in graph["publishes"]
    assert [KINEMATIC_STATE, [ODOMETRY]] in graph["subscribes"]
    island.close()
    ros.expect(event("graph", lambda found: found["nodes"] == ["ros_peer"]))


def test_ros_sees_that_a_publisher_is_closed_while_its_node_lives(
    namespace: Namespace, ros_node: RosNode
) -> None:
    ros = ros_node(DOMAIN)
    island = namespace.island("tests.network.peer", "come-and-go", str(DOMAIN), "lo")

    def publishers(count: int) -> Callable[[Any], bool]:
        return lambda graph: (
            "safety_island" in graph["nodes"]
            and len(graph["topics"]["/echo/odometry"]["publishers"]) == count
        )

    ros.expect(event("graph", publishers(1)))
    island.tell("close")
    ros.expect(event("graph", publishers(0)))


def test_ros_passes_over_what_was_taken_back(namespace: Namespace, ros_node: RosNode) -> None:
    """It hears each state once, and nothing in place of those that were taken back."""
    ros = ros_node(DOMAIN)
    island = namespace.island("tests.interop.withdrawing_peer", str(DOMAIN))
    heard = [ros.expect(event("state"))["x"] for _ in range(10)]
    assert heard == sorted(set(heard)) and heard[0] >= 1.0
    island.close()
