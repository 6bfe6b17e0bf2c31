# SPDX-License-Identifier: Apache-2.0
"""Whoever is on a topic but does not match is told once, when discovery finds it."""

from __future__ import annotations

import pytest

from safety_island.dds import topics
from tests.node.rig import ROWS, Rig

ODOMETRY = "/odometry: publisher 0a has type p/msg/T, expected nav_msgs/msg/Odometry"
STEERING = "/steering: publisher 0b does not match: reliability is best_effort"


@pytest.fixture
def found(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What discovery has found."""
    lines: list[str] = []
    monkeypatch.setattr(rig.domain, "mismatches", lambda: tuple(lines))
    rig.everything(ROWS)
    rig.tick()
    return lines


def look(rig: Rig, after_s: float = 0.15) -> None:
    """A publisher comes somewhere, so that a tick looks."""
    entry = topics.ARM
    rig.domain.publisher(entry.name, entry.type_name, entry.qos).close()
    rig.tick(after_s)


def told(rig: Rig, text: str) -> int:
    return sum(text in line for line in rig.lines)


def test_memory_has_none(rig: Rig) -> None:
    assert not rig.domain.mismatches()


def test_each_is_told_once(rig: Rig, found: list[str]) -> None:
    found += [ODOMETRY, STEERING]
    rig.tick()
    assert not told(rig, ODOMETRY)
    for _ in range(3):
        look(rig, 5.0)
    assert (told(rig, ODOMETRY), told(rig, STEERING)) == (1, 1)
    assert told(rig, "WARN") >= 2


def test_what_comes_and_goes_is_throttled(rig: Rig, found: list[str]) -> None:
    for i in range(10):
        found[:] = [ODOMETRY.replace("0a", f"0a{i}")]
        look(rig)
    assert told(rig, "/odometry: publisher") == 1
    found[:] = [ODOMETRY]
    look(rig, 3.0)
    assert told(rig, "/odometry: publisher") == 2
