# SPDX-License-Identifier: Apache-2.0
"""The clock of the main compute is set on the way: rows 32 to 34 of the catalogue, live."""

from __future__ import annotations

import time

import pytest

from safety_island.dds import topics
from safety_island.dds.topics import TopicEntry
from safety_island.input_gate.warning import InputWarning
from safety_island.life_cycle.state import State
from safety_island.messages.status_fields import Status
from tests.live.driver import Driver
from tests.live.scene import Scene, row

pytestmark = pytest.mark.live
HOUR_NS = 3600 * 10**9
AGED = tuple(entry for entry in topics.INPUTS if entry.age_limit)


@pytest.mark.parametrize("step_ns", [-HOUR_NS, HOUR_NS], ids=["back", "forward"])
def test_a_clock_that_is_set_is_told_and_ends_nothing(
    scene: Scene, driver: Driver, step_ns: int
) -> None:
    driver.engage(scene)
    before = scene.state(State.ACTIVE).message
    assert not any(item.warnings & InputWarning.CLOCK_STEP for item in before.inputs)
    driver.ahead_ns = step_ns
    both = InputWarning.CLOCK_STEP | InputWarning.CLOCK
    for entry in AGED:

        def is_told(status: Status, entry: TopicEntry = entry) -> bool:
            return row(status, entry).warnings & both == both

        assert scene.status(is_told, "it is told").message.state == State.ACTIVE
    over = scene.status(
        lambda status: not any(i.warnings & InputWarning.CLOCK_STEP for i in status.inputs),
        "the step is over",
    ).message
    assert (over.state, row(over, topics.ODOMETRY).warnings & both) == (
        State.ACTIVE,
        InputWarning.CLOCK,
    )


@pytest.mark.parametrize("rate", [0.5, 2.0])
def test_a_clock_that_runs_at_another_rate_is_told_and_ends_nothing(
    scene: Scene, driver: Driver, rate: float
) -> None:
    """Simulation time: the stamps fall behind, or run ahead."""
    driver.engage(scene)
    begin = time.monotonic()

    def send() -> None:
        driver.ahead_ns = round((rate - 1.0) * (time.monotonic() - begin) * 1e9)
        driver.send()

    scene.meanwhile = send
    since = len(scene.island.heard[topics.STATUS])
    scene.status(
        lambda status: all(row(status, entry).warnings & InputWarning.CLOCK_RATE for entry in AGED),
        "the rate is told",
    )
    statuses = scene.island.heard[topics.STATUS][since:]
    assert {one.message.state for one in statuses} == {State.ACTIVE}


def test_steps_below_the_age_limit_end_nothing(scene: Scene, driver: Driver) -> None:
    driver.engage(scene)
    since = len(scene.island.heard[topics.STATUS])
    for step_ns in (-400_000_000, -600_000_000, -600_000_000):
        driver.ahead_ns += step_ns
        for wanted in (True, False):

            def is_told(status: Status, wanted: bool = wanted) -> bool:
                bits = [item.warnings & InputWarning.CLOCK_STEP for item in status.inputs]
                return any(bits) is wanted

            scene.status(is_told, "the step is told, and over")
    statuses = scene.island.heard[topics.STATUS][since:]
    assert {one.message.state for one in statuses} == {State.ACTIVE}
