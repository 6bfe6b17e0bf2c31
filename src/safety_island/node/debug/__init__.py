# SPDX-License-Identifier: Apache-2.0
"""The debug topics: computed after a tick from what the controllers remember, when asked for."""

from safety_island.node.debug.follower import ObservedFollower
from safety_island.node.debug.publish import DebugTopics

__all__ = ["DebugTopics", "ObservedFollower"]
