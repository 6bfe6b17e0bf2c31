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
