# SPDX-License-Identifier: Apache-2.0
"""A node with a follower that only records."""

from __future__ import annotations

import pytest

from tests.node.rig import FakeFollower, Rig


@pytest.fixture
def follower() -> FakeFollower:
    """Controllers that give the command that they were given."""
    return FakeFollower()


@pytest.fixture
def rig(follower: FakeFollower) -> Rig:
    """A node over that follower."""
    return Rig(follower)
