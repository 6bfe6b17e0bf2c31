# SPDX-License-Identifier: Apache-2.0
"""Row 77 of the fault catalogue: who drives changes again and again."""

from __future__ import annotations

from itertools import pairwise

from safety_island.control.status import Mode
from safety_island.life_cycle.state import State
from tests.faults.checks import (
    BOTH,
)
from tests.faults.scene import SLOW, Row, Scene


def test_row_77_a_mode_that_toggles_every_tick_is_followed_without_a_bump() -> None:
    """AUTONOMOUS and STOP in turn: the state follows in the next tick, and no output jumps."""
    scene = Scene().drive()
    scene.world._engage = False
    rows = []
    for number in range(60):
        driving = number % 2 == 1
        scene.world.mode = Mode.AUTONOMOUS if driving else Mode.STOP
        scene.main_compute.publish_vehicle()
        rows.append(scene.tick())
        assert rows[-1].state is (State.ACTIVE if driving else State.READY)
        assert rows[-1].output == "published"
    assert_bumpless([row for row in rows if row.state is State.ACTIVE], 2 * SLOW)


@BOTH
def test_row_77_leaving_and_engaging_again_is_bumpless(period_s: float) -> None:
    scene = Scene(period_s).drive()
    for _ in range(4):
        begin = len(scene.rows) - 1
        scene.world._engage = False
        scene.disengage()
        assert scene.run(0.6)[-1].state is State.READY
        scene.world._engage = True
        assert scene.run(0.6)[-1].state is State.ACTIVE
        assert_bumpless(scene.rows[begin:], period_s)


def assert_bumpless(rows: list[Row], period_s: float) -> None:
    """Steering within its rate, acceleration within its jerk, no jump of the speed."""
    commands = [row.command for row in rows if row.command is not None]
    assert len(commands) == len(rows)
    for a, b in pairwise(commands):
        assert abs(b.steering_tire_angle - a.steering_tire_angle) <= 0.7 * period_s
        assert -5.0 * period_s <= b.acceleration - a.acceleration <= 2.0 * period_s + 1e-6
        assert abs(b.velocity - a.velocity) <= 5.0 * period_s
