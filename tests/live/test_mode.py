# SPDX-License-Identifier: Apache-2.0
"""What the operation mode's publisher said last is in force: rows 81 and 82, live."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from collections.abc import Iterator

import pytest

from safety_island.control.status import Mode
from safety_island.dds import topics
from safety_island.dds.topics import TopicEntry
from safety_island.input_gate.reason import SampleReason
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from tests.live.driver import Driver
from tests.live.scene import ISLAND, Scene, refused, row

pytestmark = pytest.mark.live
MODE = topics.OPERATION_MODE
LAPSED_S = 1.4
"""Time [s] after which a lease of 1 s has lapsed."""
ROUNDS = 3
FLOOD_HZ = 2000.0


@pytest.fixture
def deep(scene: Scene) -> Iterator[Driver]:
    """An island, and a publisher of the mode that keeps ten messages, as a bridge may."""
    scene.start(ISLAND)
    driver = Driver(scene.domains[1], mode_depth=10)
    scene.meanwhile = driver.send
    yield driver
    driver.close()


def test_a_history_that_is_delivered_again_leaves_the_stop_in_force(
    scene: Scene, deep: Driver
) -> None:
    """The island stands still for longer than a lease, and its matches are renewed."""
    deep.engage(scene)
    known = 0
    for _ in range(ROUNDS):
        for mode in (Mode.AUTONOMOUS, Mode.STOP) * 3:
            deep.tell(mode)
        scene.state(State.READY, Reason.NOT_AUTONOMOUS)
        since = len(scene.island.heard[topics.STATUS])
        scene.signal(ISLAND, signal.SIGSTOP)
        end = time.monotonic() + LAPSED_S
        scene.until(lambda end=end: time.monotonic() > end, "the lease has lapsed")  # type: ignore[misc]
        scene.signal(ISLAND, signal.SIGCONT)
        again = scene.status(
            lambda s, known=known: refused(s, MODE, SampleReason.DUPLICATE) > known,  # type: ignore[misc]
            "the history comes again",
        )
        known = refused(again.message, MODE, SampleReason.DUPLICATE)
        scene.state(State.READY, Reason.NOT_AUTONOMOUS)
        statuses = scene.island.heard[topics.STATUS][since:]
        assert {one.message.operation_mode for one in statuses} == {Mode.STOP}
        assert not any(one.message.state == State.ACTIVE for one in statuses)
    deep.tell(Mode.AUTONOMOUS)
    scene.state(State.ACTIVE)


@pytest.mark.parametrize("entry", [MODE, topics.ODOMETRY], ids=lambda entry: entry.key)
def test_a_publisher_that_floods_does_not_hide_the_owner(
    scene: Scene, driver: Driver, entry: TopicEntry
) -> None:
    driver.engage(scene)
    command = [sys.executable, "-m", "tests.live.flood", str(scene.domains[1]), entry.key]
    with subprocess.Popen([*command, str(FLOOD_HZ)]) as flood:
        try:
            begun = scene.status(
                lambda s: refused(s, entry, SampleReason.OTHER_PUBLISHER) > FLOOD_HZ / 2, "a flood"
            )
            assert begun.message.state == State.ACTIVE
            for _ in range(ROUNDS):
                driver.tell(Mode.STOP)
                scene.state(State.READY, Reason.NOT_AUTONOMOUS)
                driver.tell(Mode.AUTONOMOUS)
                ended = scene.state(State.ACTIVE)
            assert row(ended.message, entry).other_writers == 1
        finally:
            flood.kill()


def test_a_successor_s_mode_counts_though_it_was_kept_out(scene: Scene, driver: Driver) -> None:
    """It said AUTONOMOUS long ago, under the eyes of nobody, and does not say it again."""
    driver.engage(scene)
    driver.tell(Mode.STOP)
    scene.state(State.READY, Reason.NOT_AUTONOMOUS)
    other = Driver(scene.domains[1], Mode.AUTONOMOUS)
    scene.status(lambda s: refused(s, MODE, SampleReason.OTHER_PUBLISHER) == 1, "it is kept out")
    driver.close()
    scene.meanwhile = other.send
    active = scene.state(State.ACTIVE).message
    assert active.operation_mode == Mode.AUTONOMOUS
    other.close()
