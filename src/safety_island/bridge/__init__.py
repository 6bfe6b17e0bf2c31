# SPDX-License-Identifier: Apache-2.0
"""The domain bridge: forwards topics between DDS domains as bytes, as ROS 2's bridge does."""

from safety_island.bridge.program import BridgeOptions, run

__all__ = ["BridgeOptions", "run"]
