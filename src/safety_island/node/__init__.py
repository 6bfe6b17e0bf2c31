# SPDX-License-Identifier: Apache-2.0
"""Nodes: publishers, subscriptions and a timer on any platform, and the controller node."""

from safety_island.node.controller import ControllerNode
from safety_island.node.node import Node
from safety_island.node.report import Outcome, TickReport
from safety_island.node.transport import open_transport

__all__ = ["ControllerNode", "Node", "Outcome", "TickReport", "open_transport"]
