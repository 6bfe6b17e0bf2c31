# SPDX-License-Identifier: Apache-2.0
"""Rows 32 to 37 of the fault catalogue: clocks that step, differ, wrap or stand still."""

from __future__ import annotations

from itertools import pairwise
from random import Random

import pytest

from safety_island.can.receiver import CommandReceiver, Verdict
from safety_island.input_gate.reason import SampleReason
from safety_island.input_gate.warning import InputWarning
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.messages.outputs import Control
from tests.faults import wire
from tests.faults.checks import (
    BOTH,
    LIMIT_S,
    bound,
    rearms,
    recovers,
    silent_within,
    stays_active,
    stays_latched,
    warned,
)
from tests.faults.scene import AGED, EPOCH_NS, FAST, SLOW, Row, Scene

HOUR_NS = 3600 * 10**9
STEP = InputWarning.CLOCK_STEP
DAYS_49_7_NS = 2**32 * 10**6
LAST_SECOND = 2**31 - 1
"""The year 2038: a stamp of 32 bits cannot name 2262."""


def on_the_grid(rows: list[Row], period_s: float) -> bool:
    """Whether no tick was late or missed."""
    steps = [b.at - a.at for a, b in pairwise(rows)]
    return all(abs(step - period_s) < 1e-6 for step in steps) and not any(r.skipped for r in rows)


def stamps(command: Control) -> list[int]:
    """The three stamps of a command [ns]: of the whole and of both parts."""
    found = (command.stamp, command.longitudinal_stamp, command.lateral_stamp)
    return [stamp.nanoseconds for stamp in found if stamp is not None]


@BOTH
@pytest.mark.parametrize("step_ns", [-HOUR_NS, HOUR_NS], ids=["row_32_back", "row_33_forward"])
def test_row_32_row_33_a_step_of_the_islands_wall_clock(period_s: float, step_ns: int) -> None:
    """No tick is missed and nothing counts as stale; only the stamps of commands step."""
    twin, scene = Scene(period_s).drive(), Scene(period_s).drive()
    warnings = warned(scene)
    scene.clock.set_wall_offset_ns(EPOCH_NS + step_ns)
    rows, others = stays_active(scene, 10.0), stays_active(twin, 10.0)
    assert on_the_grid(rows, period_s)
    for row, other in zip(rows, others, strict=True):
        assert row.command is not None and other.command is not None
        for mine, its in zip(stamps(row.command), stamps(other.command), strict=True):
            assert mine - its == step_ns
        assert row.command[2:-1] == other.command[2:-1]
    assert {warnings[key] for key in AGED} == {InputWarning.CLOCK}


@BOTH
@pytest.mark.parametrize("step_ns", [-HOUR_NS, HOUR_NS], ids=["row_32_back", "row_33_forward"])
def test_row_32_row_33_a_step_of_the_main_computes_wall_clock(
    period_s: float, step_ns: int
) -> None:
    """Back: its stamps are older than those held, but they go on, so it is a clock."""
    scene = Scene(period_s).drive()
    warnings = warned(scene)
    scene.remote_clock.set_wall_offset_ns(EPOCH_NS + step_ns)
    assert on_the_grid(stays_active(scene, 10.0), period_s)
    assert all(warnings[key] & STEP for key in AGED)
    assert not any(bits & STEP for bits in scene.node.inputs.warnings)
    steps_back = [scene.input(key).stamps.steps_back for key in AGED]
    assert steps_back == ([1] * 4 if step_ns < 0 else [0] * 4)


@BOTH
@pytest.mark.parametrize("skew_ms", [-5000, -500, -100, 100, 500, 5000])
def test_row_34_the_skew_of_a_sender_changes_no_command(period_s: float, skew_ms: int) -> None:
    twin, scene = Scene(period_s), Scene(period_s, skew_ns=skew_ms * 1_000_000)
    warnings = warned(scene)
    assert scene.drive().rows == twin.drive().rows
    assert stays_active(scene, 10.0) == stays_active(twin, 10.0)
    for key in AGED:
        if abs(skew_ms) > 100:  # the limit itself, with or without the time on the way
            assert warnings[key] & InputWarning.CLOCK, (key, warnings[key])
        assert not warnings[key] & STEP


@pytest.mark.parametrize("skew_ms", [-5000, -100, 100, 5000])
def test_row_34_a_skew_that_comes_on_the_way_ends_nothing(skew_ms: int) -> None:
    scene = Scene().drive()
    warnings = warned(scene)
    scene.remote_clock.set_wall_offset_ns(EPOCH_NS + skew_ms * 1_000_000)
    stays_active(scene, 10.0)
    for key in AGED:  # what is 0.1 s off may as well be a delay
        assert bool(warnings[key] & STEP) is (abs(skew_ms) > 100), (key, warnings[key])


@BOTH
def test_row_34_a_stop_is_heard_after_a_step_back(period_s: float) -> None:
    """Its stamp is older than that of the engagement, and it is told once."""
    scene = Scene(period_s).drive()
    scene.remote_clock.set_wall_offset_ns(EPOCH_NS - HOUR_NS)
    scene.world._engage = False
    scene.disengage()
    warnings = warned(scene)
    assert scene.run(0.3)[-1].state is State.READY
    assert warnings["operation_mode"] & STEP


@BOTH
def test_row_34_an_engagement_is_heard_after_a_step_back(period_s: float) -> None:
    """Older than the STOP before it: the other inputs show that the clock was set back."""
    scene = Scene(period_s).drive()
    scene.world._engage = False
    scene.disengage()
    assert scene.run(1.0)[-1].state is State.READY
    scene.remote_clock.set_wall_offset_ns(EPOCH_NS - HOUR_NS)
    scene.run(1.0)
    scene.world._engage = True
    assert scene.run(1.0)[-1].state is State.ACTIVE


@BOTH
@pytest.mark.parametrize("step_ns", [0, -HOUR_NS], ids=["same_clock", "set_back"])
def test_row_34_an_old_engagement_is_not_taken_for_one_by_a_clock_set_back(
    period_s: float, step_ns: int
) -> None:
    """A stamp that is older gives no autonomy by itself, whatever was done to the clock."""
    scene = Scene(period_s).drive()
    scene.world._engage = False
    ((_, old),) = wire.stamped(*divmod(scene.remote_clock.wall_ns() - 10**9, 10**9))(
        scene.wires["operation_mode"].sent[0]
    )
    scene.disengage()
    assert scene.run(1.0)[-1].state is State.READY
    scene.remote_clock.set_wall_offset_ns(EPOCH_NS + step_ns)
    scene.run(1.0)
    scene.wires["operation_mode"].release([old])
    assert {row.state for row in scene.run(1.0)} == {State.READY}


def test_row_34_stamps_keep_no_dead_input_alive() -> None:
    """The last sample is from the future by its stamp; it ages all the same."""
    scene = Scene(skew_ns=HOUR_NS).drive()
    silent_within(scene, scene.inject(wire.drop, "odometry"), bound("odometry", SLOW))


NO_TIMES = {
    "zero": (0, 0),
    "negative": (-1, 5),
    "earliest": (-(2**31), 0),
    "nanoseconds": (2000, 10**9),
    "most_nanoseconds": (2000, 2**32 - 1),
}


@pytest.mark.parametrize("key", AGED)
@pytest.mark.parametrize("name", NO_TIMES)
def test_row_35_a_stamp_that_is_no_time_is_refused(key: str, name: str) -> None:
    scene = Scene().drive()
    since = scene.inject(wire.stamped(*NO_TIMES[name]), key)
    silent_within(scene, since, bound(key, SLOW))
    assert set(scene.input(key).refused) == {SampleReason.BAD_STAMP}
    recovers(scene, Reason.INPUT_STALE)


@BOTH
@pytest.mark.parametrize("key", AGED)
def test_row_35_one_stamp_from_the_far_future_blinds_nobody(key: str, period_s: float) -> None:
    """What comes after it looks old, for half the age limit at most."""
    scene = Scene(period_s).drive()
    scene.idle(0.09 if key == "trajectory" and period_s == SLOW else period_s - 0.01)
    scene.inject(wire.once(wire.stamped(LAST_SECOND, 0)), key)
    stays_active(scene, 5.0)


def test_row_36_the_stamps_and_counters_on_can_wrap() -> None:
    """49.7 days of uptime; what a receiver accepts does not change (tests/can has the bits)."""
    scene = Scene(start_ns=DAYS_49_7_NS - 10**10)
    can = scene.node.sender.outputs[-1]
    can._sequence = 65_500  # type: ignore[attr-defined]
    receiver = CommandReceiver(SLOW)
    verdicts: list[object] = []
    log = scene._log

    def listen(*report: object) -> None:
        verdicts.extend(receiver.feed(frame, scene.now) for frame in scene.bus.frames)
        log(*report)  # type: ignore[arg-type]

    scene.node.observers[:] = [listen]
    scene.drive()
    stays_active(scene, 20.0)
    assert scene.clock.monotonic_ns() > DAYS_49_7_NS
    assert can._sequence < 65_500  # type: ignore[attr-defined]
    ticks = len(scene.rows)
    assert verdicts.count(Verdict.ACCEPTED) == ticks - 1  # the first shows where the counter is


@BOTH
def test_row_37_a_machine_that_slept_begins_anew(period_s: float) -> None:
    """The monotonic clock has stood still, so no age has grown: only the sleep tells."""
    scene = Scene(period_s).drive()
    scene.clock.sleep_ns(60 * 10**9)
    row = scene.tick()
    assert (row.state, row.output) == (State.INIT, "silent")
    assert row.speed > 1.0
    scene.run(1.0)
    stays_latched(scene, Reason.STALLED)
    rearms(scene)


@pytest.mark.parametrize("period_s", [SLOW, FAST])
def test_row_37_a_short_nap_is_no_restart(period_s: float) -> None:
    scene = Scene(period_s).drive()
    scene.clock.sleep_ns(100_000_000)
    stays_active(scene, 2.0)


def test_row_37_can_only_has_no_ramp_after_a_sleep() -> None:
    """Nobody knows how the vehicle moves after a sleep: a ramp would start from old numbers."""
    scene = Scene(has_ramp=True).drive()
    scene.clock.sleep_ns(60 * 10**9)
    assert {row.output for row in scene.run(1.0)} == {"silent"}


STEPS_S = {
    "two": [(1.0, -0.4), (2.5, -0.6)],
    "one_after_the_other": [(1.0, -0.4), (0.2, -0.6)],
    "a_hundred_seconds_apart": [(1.0, -0.6), (100.0, -0.6)],
    "many_small_ones": [(1.0, -0.1)] * 20,
    "below_a_period": [(0.5, -0.02)] * 60,
    "to_and_fro": [(1.0, 0.4), (1.0, -0.4), (1.0, 0.3), (1.0, -0.3)] * 4,
}
"""After how long [s] the clock of the main compute is set by how much [s], again and again."""


@BOTH
@pytest.mark.parametrize("steps", STEPS_S.values(), ids=STEPS_S.keys())
def test_row_87_steps_below_the_age_limit_are_no_delay(
    period_s: float, steps: list[tuple[float, float]]
) -> None:
    scene = Scene(period_s).drive()
    warnings = warned(scene)
    offset_ns = EPOCH_NS
    for after_s, step_s in steps:
        stays_active(scene, after_s)
        offset_ns += round(step_s * 1e9)
        scene.remote_clock.set_wall_offset_ns(offset_ns)
    stays_active(scene, 5.0)
    assert all(scene.input(key).stamps.delay_s < LIMIT_S[key] * 0.6 for key in AGED)
    if min(step for _, step in steps) < -0.3:
        assert all(warnings[key] & STEP for key in AGED[1:])


@BOTH
def test_row_87_any_steps(period_s: float, random: Random) -> None:
    scene = Scene(period_s).drive()
    offset_ns = EPOCH_NS
    for _ in range(40):
        stays_active(scene, random.uniform(0.5, 4.0))
        offset_ns += random.randint(-850_000_000, 850_000_000)
        scene.remote_clock.set_wall_offset_ns(offset_ns)
    stays_active(scene, 5.0)


def run_at(scene: Scene, rate: float) -> None:
    """Let the clock of the main compute run at another rate from now on."""
    clock = scene.remote_clock
    wall_ns, since_ns = clock.wall_ns(), clock.monotonic_ns()
    clock.wall_ns = (  # type: ignore[method-assign]
        lambda: wall_ns + round(rate * (clock.monotonic_ns() - since_ns))
    )


@BOTH
@pytest.mark.parametrize("rate", [0.5, 0.8, 0.95, 1.05, 1.5, 2.0])
def test_row_88_a_clock_at_another_rate_is_driven_by(period_s: float, rate: float) -> None:
    """Simulation time: the stamps of all inputs fall behind, or run ahead, together."""
    scene = Scene(period_s).drive()
    warnings = warned(scene)
    run_at(scene, rate)
    stays_active(scene, 30.0)
    assert all(warnings[key] & InputWarning.CLOCK_RATE for key in AGED)
    assert "run slowly or fast" in scene.log_text
    run_at(scene, 1.0)
    stays_active(scene, 10.0)
    assert not any(bits & InputWarning.CLOCK_RATE for bits in scene.node.inputs.warnings)


@BOTH
def test_row_88_a_lost_input_ends_the_output_all_the_same(period_s: float) -> None:
    scene = Scene(period_s).drive()
    run_at(scene, 0.5)
    stays_active(scene, 5.0)
    silent_within(scene, scene.inject(wire.drop, "odometry"), bound("odometry", period_s))


@BOTH
@pytest.mark.parametrize("rate", [0.5, 0.8])
def test_row_88_a_delay_of_one_input_is_found_by_a_slow_clock(period_s: float, rate: float) -> None:
    scene = Scene(period_s).drive()
    run_at(scene, rate)
    stays_active(scene, 5.0)
    since = scene.now
    scene.inject(lambda data: [((scene.now - since) * 0.5, data)], "odometry")
    silent_within(scene, since, 4.0, margin_s=5.0)
    assert scene.refused("odometry", SampleReason.DELAYED) > 0
