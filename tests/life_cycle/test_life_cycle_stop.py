# SPDX-License-Identifier: Apache-2.0
"""CAN_ONLY at work: hold, stop, silence."""

from __future__ import annotations

import pytest

from safety_island.life_cycle.ramp import Motion
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.life_cycle.transition import Life
from tests.life_cycle.rig import GONE, HELD, MANUAL, STALE, WELL, Island, T


def island(**changes: float) -> Island:
    return Island(has_ramp=True, **changes).engage()


def step(island: Island, blocked: Reason = STALE, speed: float = 2.0) -> tuple[str, Motion | None]:
    state = island.tick(blocked, speed=speed).state
    return state.name, island.life_cycle.motion()


def test_the_last_command_is_held_and_then_led_to_a_stop() -> None:
    stopping = island()
    assert step(stopping) == ("HOLD", HELD)
    assert step(stopping) == ("HOLD", HELD)
    assert step(stopping) == ("STOP", Motion(0.25, 0.0, 1.875, -1.0))
    assert step(stopping, speed=9.0) == ("STOP", Motion(0.25, 0.0, 1.6875, -1.5))


@pytest.mark.parametrize(("ticks", "states"), [(0, ["STOP"] * 2), (1, ["HOLD", "STOP"])])
def test_how_long_it_is_held(ticks: int, states: list[str]) -> None:
    stopping = island(hold_ticks=ticks)
    assert [step(stopping)[0] for _ in range(2)] == states


def test_after_the_stop_there_is_silence() -> None:
    stopping = island()
    found = [step(stopping) for _ in range(40)]
    names = [name for name, _ in found]
    count = names.count("STOP")
    assert names == ["HOLD"] * 2 + ["STOP"] * count + ["SILENT"] * (38 - count)
    assert [motion for name, motion in found if name == "SILENT"] == [None] * (38 - count)
    standing = [motion for name, motion in found if name == "STOP" and motion == found[count][1]]
    assert len(standing) == 5  # 0.5 s after the first
    assert stopping.life == Life(State.SILENT, STALE, STALE)


def test_a_cause_that_goes_while_it_is_held_leaves_no_trace() -> None:
    stopping = island()
    step(stopping)
    assert stopping.tick() == WELL
    assert stopping.life_cycle.motion() is None
    assert [step(stopping)[0] for _ in range(3)] == ["HOLD", "HOLD", "STOP"]


def test_a_stop_that_has_begun_is_carried_through() -> None:
    stopping = island(hold_ticks=0)
    step(stopping)
    assert stopping.tick() == Life(State.STOP, STALE, STALE)
    assert stopping.tick(arm=True).state is State.STOP


def test_without_anybody_who_tells_the_mode_it_is_carried_through() -> None:
    stopping = island(hold_ticks=0)
    step(stopping)
    assert stopping.tick(STALE, GONE) == Life(State.STOP, STALE, STALE)
    assert stopping.tick(disengaged=GONE) == Life(State.STOP, GONE, STALE)
    assert stopping.life_cycle.motion() is not None


def test_a_mode_that_nobody_tells_is_a_cause() -> None:
    stopping = island()
    names = []
    for _ in range(4):
        assert stopping.tick(disengaged=GONE)[1:] == (GONE, GONE)
        stopping.life_cycle.motion()
        names.append(stopping.life.state.name)
    assert names == ["HOLD", "HOLD", "STOP", "STOP"]


def test_an_operator_ends_it_and_the_next_stop_begins_anew() -> None:
    stopping = island()
    for _ in range(5):
        step(stopping)
    assert stopping.tick(disengaged=MANUAL) == Life(State.READY, MANUAL)
    assert stopping.life_cycle.motion() is None
    assert stopping.tick() == WELL
    assert [step(stopping)[0] for _ in range(3)] == ["HOLD", "HOLD", "STOP"]
    assert step(stopping)[1] == Motion(0.25, 0.0, 1.6875, -1.5)


def test_a_command_that_did_not_go_out_is_not_what_is_held() -> None:
    stopping = island()
    stopping.life_cycle.sent(Motion(0.5, 0.5, 0.5, 0.5), False, stopping.now)
    assert step(stopping) == ("HOLD", HELD)


def test_before_any_command_went_out_nothing_is_held() -> None:
    stopping = Island(has_ramp=True)
    stopping.went_out = False
    stopping.engage()
    assert step(stopping) == ("HOLD", Motion(0.0, 0.0, 0.0, 0.0))


def test_ticks_that_were_missed_make_neither_hold_nor_ramp_longer() -> None:
    """Every second tick: half as many commands, each a step of twice the time."""
    stopping = island()
    stopping.now += T
    assert step(stopping) == ("HOLD", HELD)
    stopping.now += T
    assert step(stopping) == ("STOP", Motion(0.25, 0.0, 1.625, -1.5))
    stopping.now += T
    assert step(stopping) == ("STOP", Motion(0.25, 0.0, 1.125, -2.0))


def test_a_tick_that_comes_early_is_half_a_period_at_least() -> None:
    stopping = island(hold_ticks=0)
    stopping.now -= 0.75 * T
    assert step(stopping) == ("STOP", Motion(0.25, 0.0, 2.0 - 0.75 * 0.0625, -0.75))


ENDING = Reason.SHUTTING_DOWN


def test_told_to_end_it_stops_first_and_says_why() -> None:
    ending = island()
    assert ending.life_cycle.must_stop
    names = []
    while ending.life_cycle.must_stop:
        assert ending.tick(ENDING).cause is ENDING
        names.append(ending.life.state.name)
        ending.life_cycle.motion()
    count = names.count("STOP")
    assert names == ["HOLD"] * 2 + ["STOP"] * count + ["SILENT"]
    assert ending.life == Life(State.SILENT, ENDING, ENDING)


def test_a_stop_that_goes_on_is_carried_through_before_the_end() -> None:
    ending = island()
    step(ending)
    assert ending.life_cycle.must_stop
    step(ending, speed=0.0)
    assert ending.life_cycle.must_stop


def test_an_operator_who_takes_over_ends_it_at_once() -> None:
    ending = island()
    for _ in range(4):
        ending.tick(ENDING)
        ending.life_cycle.motion()
    assert ending.tick(ENDING, disengaged=MANUAL) == Life(State.INIT, ENDING)
    assert not ending.life_cycle.must_stop


@pytest.mark.parametrize(
    ("speed", "command", "must_stop"),
    [
        (0.0, (0.0, -1.0), False),
        (0.0, (0.0, 0.0), False),
        (0.124, (0.124, -1.0), False),
        (-0.124, (-0.124, -1.0), False),
        (0.125, (0.0, -1.0), True),
        (-0.125, (0.0, -1.0), True),
        (float("nan"), (0.0, -1.0), True),
        (0.0, (0.125, -1.0), True),
        (0.0, (-0.125, -1.0), True),
        (0.0, (0.0, 0.0625), True),
    ],
)
def test_a_vehicle_that_stands_and_is_told_to_need_not_be_stopped(
    speed: float, command: tuple[float, float], must_stop: bool
) -> None:
    standing = island()
    standing.tick(speed=speed)
    standing.life_cycle.sent(Motion(0.25, 0.0, *command), True, standing.now)
    assert standing.life_cycle.must_stop is must_stop


def test_who_is_not_armed_or_has_a_gate_may_end_at_once() -> None:
    assert not Island(has_ramp=True).life_cycle.must_stop
    ready = Island(has_ramp=True)
    ready.tick(disengaged=MANUAL)
    assert ready.life.state is State.READY and not ready.life_cycle.must_stop
    assert not Island().engage().life_cycle.must_stop


def test_who_is_armed() -> None:
    driving = island()
    assert driving.life_cycle.is_armed
    for state in ("HOLD", "HOLD", "STOP"):
        assert step(driving)[0] == state
        assert driving.life_cycle.is_armed
    while step(driving)[0] != "SILENT":
        pass
    assert not driving.life_cycle.is_armed


def test_without_a_publisher_of_the_mode_it_is_still_armed() -> None:
    waiting = Island()
    waiting.tick(disengaged=GONE)
    assert waiting.life == Life(State.READY, GONE) and not waiting.life_cycle.is_armed
    waiting = Island().engage()
    waiting.tick(disengaged=GONE)
    assert waiting.life == Life(State.READY, GONE, GONE) and waiting.life_cycle.is_armed
