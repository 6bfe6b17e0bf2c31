# SPDX-License-Identifier: Apache-2.0
# mypy: ignore-errors
"""A ROS 2 node, run by the Python that has rclpy: publishes, subscribes, and tells what it sees.

Every 50 ms it publishes Odometry and AccelWithCovarianceStamped with a running number; it listens
for both on ``/echo/...``, and watches the ROS graph. Each event is one JSON line. It ends when its
standard input closes.
"""

import json
import sys
import threading

import rclpy
from geometry_msgs.msg import AccelWithCovarianceStamped
from nav_msgs.msg import Odometry
from rclpy.qos import DurabilityPolicy, QoSProfile

ODOMETRY = "/localization/kinematic_state"
ACCELERATION = "/localization/acceleration"
STATE = "/echo/state"
DISCOVERY = "ros_discovery_info"
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def tell(event, **values):
    print(json.dumps({"event": event, **values}), flush=True)


def odometry(number):
    message = Odometry()
    message.header.frame_id = "map"
    message.header.stamp.sec = number
    message.child_frame_id = "base_link"
    message.pose.pose.position.x = float(number)
    message.pose.covariance[35] = 0.5
    message.twist.twist.angular.z = -float(number)
    return message


def acceleration(number):
    message = AccelWithCovarianceStamped()
    message.header.frame_id = "/base_link"
    message.header.stamp.sec = number
    message.accel.accel.linear.x = float(number)
    return message


def heard_odometry(message):
    position, angular = message.pose.pose.position, message.twist.twist.angular
    frames = [message.header.frame_id, message.child_frame_id]
    tell("odometry", x=position.x, wz=angular.z, frames=frames, cov=message.pose.covariance[35])


def heard_acceleration(message):
    tell("acceleration", ax=message.accel.accel.linear.x, frame=message.header.frame_id)


def heard_state(message):
    tell("state", x=message.pose.pose.position.x)


def endpoints(infos):
    return [[info.topic_type, str(info.topic_type_hash)] for info in infos]


def graph(node):
    nodes = sorted(name for name, _ in node.get_node_names_and_namespaces())
    found = {"nodes": nodes, "topics": {}}
    for topic in (ODOMETRY, "/echo/odometry"):
        found["topics"][topic] = {
            "publishers": endpoints(node.get_publishers_info_by_topic(topic)),
            "subscriptions": endpoints(node.get_subscriptions_info_by_topic(topic)),
        }
    found["hashes"] = {
        topic: endpoints(node.get_publishers_info_by_topic(topic))
        for topic in (ODOMETRY, ACCELERATION)
    }
    discovery = node.get_publishers_info_by_topic(DISCOVERY, no_mangle=True)
    found["hashes"][DISCOVERY] = [
        [name.replace("::dds_::", "/").replace("::", "/").rstrip("_"), hashed]
        for name, hashed in endpoints(discovery)
    ]
    if "safety_island" in nodes:
        found["publishes"] = node.get_publisher_names_and_types_by_node("safety_island", "/")
        found["subscribes"] = node.get_subscriber_names_and_types_by_node("safety_island", "/")
    return found


def main():
    rclpy.init()
    node = rclpy.create_node("ros_peer")
    odometry_out = node.create_publisher(Odometry, ODOMETRY, 1)
    acceleration_out = node.create_publisher(AccelWithCovarianceStamped, ACCELERATION, 1)
    node.create_subscription(Odometry, "/echo/odometry", heard_odometry, 1)
    node.create_subscription(
        AccelWithCovarianceStamped, "/echo/acceleration", heard_acceleration, 1
    )
    node.create_subscription(Odometry, STATE, heard_state, LATCHED)
    over = threading.Event()
    threading.Thread(target=lambda: (sys.stdin.read(), over.set()), daemon=True).start()
    number, before = 0, None
    while not over.is_set():
        number += 1
        odometry_out.publish(odometry(number))
        acceleration_out.publish(acceleration(number))
        rclpy.spin_once(node, timeout_sec=0.05)
        now = graph(node)
        if now != before:
            tell("graph", **now)
            before = now
    rclpy.shutdown()


if __name__ == "__main__":
    main()
