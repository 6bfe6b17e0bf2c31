# SPDX-License-Identifier: Apache-2.0
"""An island in a process of its own: python -m tests.node.live_island DOMAIN_ID."""

from __future__ import annotations

import sys

from safety_island.control.follower import TrajectoryFollower
from safety_island.dds.config import DdsConfig
from safety_island.node.controller import NAME, ControllerNode
from safety_island.node.transport import open_transport
from safety_island.params import load_set
from safety_island.platform import load
from safety_island.platform.posix.process import leave


def main(domain_id: int) -> None:
    """Run on loopback until a signal comes."""
    platform = load("posix")
    parameters = load_set("default")
    follower = TrajectoryFollower(parameters)
    transport = open_transport(platform, domain_id, DdsConfig(loopback_only=True), NAME)
    with ControllerNode(platform, transport, follower, parameters) as node:
        node.run(parameters.node.ctrl_period)
    platform.logger.close()
    leave(0)


if __name__ == "__main__":
    main(int(sys.argv[1]))
