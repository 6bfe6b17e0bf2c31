# SPDX-License-Identifier: Apache-2.0
"""A scene for each test, with two DDS domains of its own."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from safety_island.control.follower import TrajectoryFollower
from safety_island.params import load_set
from tests.live.driver import Driver
from tests.live.scene import BRIDGE, ISLAND, VEHICLE, Scene


@pytest.fixture(scope="session")
def compiled() -> None:
    """Compiles the kernels, so that no test waits for that."""
    TrajectoryFollower(load_set("default"))


@pytest.fixture
def scene(compiled: None, domain_pair: tuple[int, int], tmp_path: Path) -> Iterator[Scene]:
    """No process yet."""
    scene = Scene(domain_pair, tmp_path)
    yield scene
    scene.close()


@pytest.fixture
def drive(scene: Scene) -> Scene:
    """Island, bridge and main compute; the vehicle drives."""
    for name in (ISLAND, BRIDGE, VEHICLE):
        scene.start(name)
    scene.moves()
    return scene


@pytest.fixture
def driver(scene: Scene) -> Iterator[Driver]:
    """An island alone, and a main compute of the test's own on its domain."""
    scene.start(ISLAND)
    driver = Driver(scene.domains[1])
    scene.meanwhile = driver.send
    yield driver
    driver.close()
