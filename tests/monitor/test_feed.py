# SPDX-License-Identifier: Apache-2.0
"""What comes on the domain reaches the hub as it was published."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from safety_island.dds import topics
from safety_island.dds.config import DdsConfig
from safety_island.dds.participant import Participant
from safety_island.life_cycle.state import State
from safety_island.messages.inputs import (
    Acceleration,
    Odometry,
    Steering,
    encode_acceleration,
    encode_odometry,
    encode_steering,
)
from safety_island.messages.points import POINT
from safety_island.messages.trajectory import encode_trajectory
from safety_island.messages.wire import Time
from safety_island.monitor.feed import Feed
from safety_island.monitor.fields import FIELDS
from safety_island.monitor.hub import Hub
from tests.status.samples import NOT_FINITE, ODOMETRY, STALE, FakeIsland, sample

LIMIT_S = 40.0
DDS = DdsConfig(interface="lo")
POSE = (12.5, -3.0, 0.0, 0.0, 0.0, 0.0, 1.0)

pytestmark = pytest.mark.live


class Scene:
    """A monitor on a domain of its own, and the newest message of each kind."""

    def __init__(self, domain_id: int) -> None:
        self.hub = Hub({})
        self.participant = Participant(domain_id, DDS, "island_monitor")
        self.feed = Feed(self.participant, f"domain {domain_id}", "0.40", self.hub)

    def newest(self, kind: str) -> dict[str, Any]:
        return dict(self.hub._newest.get(kind, {}))

    def until(self, holds: Callable[[], object], meanwhile: Callable[[], None]) -> None:
        end = time.monotonic() + LIMIT_S
        while not holds():
            assert time.monotonic() < end, self.hub._newest
            meanwhile()
            self.participant.wait(0.02)
            self.feed.poll(time.time())


@pytest.fixture
def scene(domain_id: int) -> Iterator[Scene]:
    found = Scene(domain_id)
    yield found
    found.participant.close()


def nothing() -> None:
    """Meanwhile nothing is published."""


def test_a_status_becomes_a_row_and_words(scene: Scene, domain_id: int) -> None:
    status = sample(lateral_error=0.125)
    with FakeIsland(domain_id, status):
        scene.until(lambda: scene.newest("summary"), nothing)
    found = scene.newest("summary")
    assert found["state"] == "ACTIVE"
    assert found["flows"]
    assert found["why"].startswith("All is well")
    assert [row["name"] for row in found["inputs"]][:2] == ["trajectory", "odometry"]
    assert found["inputs"][0]["age_limit_s"] == pytest.approx(0.9)
    (rows,) = scene.hub.history.chunks()
    assert dict(zip(FIELDS, rows[-1], strict=True))["lateral_error"] == 0.125


def test_a_refusal_is_counted_and_told(scene: Scene, domain_id: int) -> None:
    with FakeIsland(domain_id, sample({ODOMETRY: NOT_FINITE}, **STALE)):
        scene.until(lambda: scene.newest("summary"), nothing)
    found = scene.newest("summary")
    assert not found["flows"]
    assert "NaN or infinite" in found["why"]
    assert found["inputs"][ODOMETRY]["refused"] == {"NOT_FINITE": 3}


def test_a_change_of_state_is_marked(scene: Scene, domain_id: int) -> None:
    seen = scene.hub.history.marks
    with FakeIsland(domain_id, sample(state=State.READY)):
        scene.until(lambda: scene.newest("summary").get("state") == "READY", nothing)
    with FakeIsland(domain_id, sample()):
        scene.until(lambda: scene.newest("summary").get("state") == "ACTIVE", nothing)
    assert [mark["text"] for mark in seen] == ["READY → ACTIVE"]


def test_without_an_island_the_page_says_what_to_do(scene: Scene, domain_id: int) -> None:
    scene.until(lambda: scene.newest("silence"), nothing)
    assert "start 'island run'" in scene.newest("silence")["why"]


def test_vehicle_and_paths_are_drawn_where_they_are(scene: Scene, domain_id: int) -> None:
    with Participant(domain_id, DDS, "planner") as other:
        points = np.zeros(3, POINT)
        points["x"], points["v"] = [1.0, 2.0, 4.0], 5.0
        stamp = Time(1, 0)
        odometry = Odometry(stamp, "map", "base_link", *POSE, 7.25, 0.0, 0.0, 0.0, 0.0, 0.0)
        acceleration = Acceleration(stamp, "base_link", -0.5, 0.0, 0.0, 0.0, 0.0, 0.0)
        said = (
            (topics.TRAJECTORY, encode_trajectory(stamp, "map", points)),
            (topics.PREDICTED_TRAJECTORY, encode_trajectory(stamp, "map", points[:2])),
            (topics.STEERING, encode_steering(Steering(stamp, 0.25))),
            (topics.ACCELERATION, encode_acceleration(acceleration)),
            (topics.ODOMETRY, encode_odometry(odometry)),
        )
        writers = [
            (other.publisher(entry.name, entry.type_name, entry.qos), data) for entry, data in said
        ]

        def publish() -> None:
            for writer, data in writers:
                writer.write(data)

        kinds = ("path", "predicted", "pose")
        scene.until(lambda: all(map(scene.newest, kinds)), publish)
        scene.until(lambda: scene.newest("pose").get("steering") == 0.25, publish)
        with FakeIsland(domain_id, sample()):
            scene.until(lambda: any(scene.hub.history.chunks()), publish)
    assert scene.newest("path")["x"] == [1.0, 2.0, 4.0]
    assert scene.newest("predicted")["v"] == [5.0, 5.0]
    assert (scene.newest("pose")["x"], scene.newest("pose")["y"]) == POSE[:2]
    (rows,) = scene.hub.history.chunks()
    measured = dict(zip(FIELDS, rows[-1], strict=True))
    assert (measured["speed"], measured["acceleration"]) == (7.25, -0.5)


def test_what_cannot_be_read_is_said_and_passed_over(scene: Scene, domain_id: int) -> None:
    with Participant(domain_id, DDS, "other") as other:
        entry = topics.STEERING
        writer = other.publisher(entry.name, entry.type_name, entry.qos)
        scene.until(writer.matched, nothing)
        scene.feed._decode(scene.feed._take_status, 1.0, b"\x00\x01\x00\x00short")
        scene.feed._say(2.0)
    assert "that can be read" in scene.newest("silence")["why"]
