# SPDX-License-Identifier: Apache-2.0
"""The frames of a bus on the page."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import closing
from typing import Any

import can
import pytest

from safety_island.can.command import Command
from safety_island.can.encoder import Rejection, encode
from safety_island.can.spec import parse_spec
from safety_island.command.mode import OutputMode
from safety_island.errors import ConfigurationError
from safety_island.monitor.bus import SHOW_EVERY_S, BusFeed
from safety_island.monitor.hub import Hub

LIMIT_S = 20.0
COMMAND = Command(steering_tire_angle=0.125, velocity=5.0)


def until(feed: BusFeed, hub: Hub, holds: Callable[[dict[str, Any]], object]) -> dict[str, Any]:
    """Poll until the page is told what is wanted."""
    end = time.monotonic() + LIMIT_S
    while True:
        feed.poll(hub, time.monotonic())
        found: dict[str, Any] = dict(hub._newest["can"])["can"]
        if holds(found):
            return found
        assert time.monotonic() < end, found
        time.sleep(SHOW_EVERY_S / 4)


def test_frames_are_shown_raw_and_decoded_and_their_loss_is_told() -> None:
    frames = encode(COMMAND, OutputMode.DDS_AND_CAN, 7, 1234)
    assert not isinstance(frames, Rejection)
    hub = Hub({})
    with (
        can.Bus("page", interface="virtual") as other,
        closing(BusFeed(parse_spec("virtual:page"), time.monotonic_ns)) as feed,
    ):
        for frame in frames:
            other.send(
                can.Message(
                    arbitration_id=frame.arbitration_id, data=frame.data, is_extended_id=False
                )
            )
        found = until(feed, hub, lambda can: can.get("sequence") == 7)
        assert found["steering_tire_angle"]["value"] == pytest.approx(0.125)
        assert (
            found["frames"][0] == f"{frames[0].arbitration_id:03X}#{frames[0].data.hex().upper()}"
        )
        assert len(found["frames"]) == len(frames)
        assert "LOST" in until(feed, hub, lambda can: "fault" in can)["fault"]


def test_a_bus_that_nobody_can_listen_to_is_said_at_once() -> None:
    with pytest.raises(ConfigurationError, match="the mock bus has nobody to listen to"):
        BusFeed(parse_spec("mock"), time.monotonic_ns)
