# SPDX-License-Identifier: Apache-2.0
"""The offset of the steering sensor: bounded at the door, and only where the release has it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from safety_island import params
from safety_island.control.follower import TrajectoryFollower
from safety_island.control.status import Refusal
from safety_island.dds import topics
from safety_island.messages.outputs import encode_float32_stamped
from safety_island.node import ControllerNode
from safety_island.node.memory import MemoryDomain
from safety_island.platform.interfaces import LogConfig, LogLevel
from safety_island.platform.sim import make

ENABLE = "steering_offset.enable_auto_steering_offset_removal"


class Scene:
    """A controller node on virtual time, and a publisher of the offset."""

    def __init__(self, **values: object) -> None:
        parameters = params.from_mapping({ENABLE: True, **values})
        platform = make(LogConfig(level=LogLevel.NONE))
        domain = MemoryDomain(platform.clock)
        self.follower = TrajectoryFollower(parameters)
        self.node = ControllerNode(platform, domain, self.follower, parameters)
        entry = topics.STEERING_OFFSET
        self.write = domain.publisher(entry.name, entry.type_name, entry.qos).write
        self.now = 1000.0

    def offset_after(self, data: bytes) -> float:
        """The offset [rad] that the controllers have after a tick."""
        self.write(data)
        self.now += 0.15
        self.node.tick(self.now)
        return float(self.follower.inputs[0].steering_offset)


def message(offset: float) -> bytes:
    return encode_float32_stamped((5, 0), offset)


def test_it_is_taken_since_051() -> None:
    scene = Scene(autoware_release="0.51")
    assert scene.offset_after(message(0.03)) == np.float32(0.03)
    assert scene.offset_after(message(-0.02)) == np.float32(-0.02)


@pytest.mark.parametrize("values", [{"autoware_release": "0.50"}, {ENABLE: False}])
def test_it_is_not_subscribed_to_elsewhere(values: dict[str, object]) -> None:
    scene = Scene(**({"autoware_release": "0.53"} | values))
    assert scene.offset_after(message(0.03)) == 0.0


@pytest.mark.parametrize(
    "data",
    [message(math.nan), message(math.inf), message(0.11), message(-3.0), b"", message(0.01)[:-1]],
)
def test_what_could_not_be_an_offset_is_refused(data: bytes) -> None:
    """In Autoware one NaN would stay in the filter for good."""
    scene = Scene(autoware_release="0.53")
    scene.offset_after(message(0.02))
    assert scene.offset_after(data) == np.float32(0.02)
    assert scene.offset_after(message(0.03)) == np.float32(0.03)


def test_the_limit_is_a_parameter() -> None:
    follower = TrajectoryFollower(params.from_mapping({"steering_offset.input_limit": 0.2}))
    assert follower.offer_steering_offset(0.15) is Refusal.ACCEPTED
    assert follower.offer_steering_offset(0.25) is Refusal.OUT_OF_RANGE
