# SPDX-License-Identifier: Apache-2.0
"""What goes wrong in a build."""

from safety_island.errors import IslandError


class BuildError(IslandError):
    """A build that cannot be finished: what, for which target or file, and why."""
