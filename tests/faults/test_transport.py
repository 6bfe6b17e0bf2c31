# SPDX-License-Identifier: Apache-2.0
"""Rows 1 to 8 of the fault catalogue: loss, delay, jitter, duplicates, reordering, backlog."""

from __future__ import annotations

from itertools import pairwise
from random import Random

import pytest

from safety_island.control.status import Mode
from safety_island.input_gate.reason import SampleReason
from safety_island.input_gate.warning import InputWarning
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from tests.faults import wire
from tests.faults.checks import (
    BOTH,
    JITTER_S,
    LIMIT_S,
    bound,
    rearms,
    recovers,
    silent_within,
    stays_active,
    stays_latched,
    subject,
    warned,
)
from tests.faults.scene import AGED, INPUTS, SLOW, Scene

FAST_INPUTS = AGED[1:]
"""Those that come at a rate that is known."""


@BOTH
@pytest.mark.parametrize("percent", [1, 5, 20])
def test_row_01_random_loss_changes_no_state(period_s: float, percent: int, random: Random) -> None:
    scene = Scene(period_s).drive()
    scene.inject(wire.lose(percent / 100, random))
    stays_active(scene, 30.0)
    scene.clear()
    stays_active(scene, 1.0)


@BOTH
def test_row_01_a_rate_that_is_too_low_is_warned_of(period_s: float, random: Random) -> None:
    """Below 90 % of the usual 35.6 Hz: the stand-in's 40 Hz bear a loss of 20 % before that."""
    scene = Scene(period_s).drive()
    warnings = warned(scene)
    stays_active(scene, 5.0)
    scene.inject(wire.lose(0.01, random), *FAST_INPUTS)
    stays_active(scene, 10.0)
    assert not any(warnings.values())
    scene.inject(wire.lose(0.4, random), *FAST_INPUTS)
    stays_active(scene, 12.0)  # two windows of a hundred samples
    assert all(warnings[key] & InputWarning.RATE for key in FAST_INPUTS)
    scene.clear()
    stays_active(scene, 6.0)
    assert not any(scene.node.inputs.warnings)


@BOTH
@pytest.mark.parametrize("phase", range(4))
@pytest.mark.parametrize("key", AGED)
def test_row_02_a_lost_topic_ends_the_output(
    key: str, phase: int, period_s: float, random: Random
) -> None:
    scene = Scene(period_s).drive()
    scene.idle(random.uniform(0.0, period_s))
    since = scene.inject(wire.drop, key)
    first = silent_within(scene, since, bound(key, period_s))
    assert (first.state, first.reason, subject(first)) == (State.SILENT, Reason.INPUT_STALE, key)
    assert first.at - since > LIMIT_S[key] - 0.1 - period_s - JITTER_S, "too early"
    assert "state SILENT" in scene.log_text
    recovers(scene, Reason.INPUT_STALE)


@pytest.mark.parametrize("key", AGED)
def test_row_02_a_lost_topic_while_ready_is_not_latched(key: str) -> None:
    scene = Scene()
    scene.world._engage = False
    assert scene.run(1.0)[-1].state is State.READY
    since = scene.inject(wire.drop, key)
    first = silent_within(scene, since, bound(key, SLOW))
    assert (first.state, first.reason) == (State.INIT, Reason.INPUT_STALE)
    scene.clear()
    rows = scene.run(0.6)
    assert (rows[-1].state, rows[-1].output) == (State.READY, "published")


@BOTH
@pytest.mark.parametrize("key", AGED)
def test_row_02_can_only_holds_then_stops_then_is_silent(key: str, period_s: float) -> None:
    scene = Scene(period_s, has_ramp=True).drive()
    since = scene.inject(wire.drop, key)
    rows = [row for row in scene.run(9.0) if row.state is not State.ACTIVE]
    assert rows[0].at - since <= bound(key, period_s)
    outputs = [row.output for row in rows]
    assert outputs == sorted(outputs, key=("held", "ramp", "silent").index)
    assert outputs.count("held") == scene.parameters.life_cycle.hold_ticks
    assert outputs[-1] == "silent"
    stopped = next(row for row in rows if row.output == "silent")
    assert stopped.speed == 0.0
    recovers(scene, Reason.INPUT_STALE)


@BOTH
def test_row_02_can_only_stops_when_the_topic_comes_back_too_late(period_s: float) -> None:
    scene = Scene(period_s, has_ramp=True).drive()
    scene.inject(wire.drop, "odometry")
    while scene.tick().state is not State.STOP:
        pass
    scene.clear()
    stopped = next(row for row in scene.run(9.0) if row.output == "silent")
    assert stopped.speed == 0.0
    rearms(scene)


@BOTH
def test_row_03_a_partition_ends_the_output_and_is_named(period_s: float) -> None:
    scene = Scene(period_s).drive()
    since = scene.inject(wire.drop)
    silent_within(scene, since, bound("odometry", period_s))
    assert scene.rows[-1].reason is Reason.PARTITION
    recovers(scene, Reason.INPUT_STALE)


@BOTH
@pytest.mark.parametrize("delay_ms", [50, 100, 200, 300])
def test_row_04_a_delay_within_the_limit_is_measured(period_s: float, delay_ms: int) -> None:
    """It is warned of by the clocks, and beyond half the limit by what it was before.

    Neither its begin nor its end is a step of a clock.
    """
    scene = Scene(period_s).drive()
    warnings = warned(scene)
    scene.inject(wire.delay(delay_ms / 1e3))
    stays_active(scene, 5.0)
    for key in AGED:
        found = scene.input(key).stamps.delay_s
        assert found == pytest.approx(delay_ms / 1e3, abs=period_s + 0.025), key
    scene.clear()
    stays_active(scene, 5.0)
    for key in AGED:
        assert bool(warnings[key]) is (delay_ms > 100), key
        is_long = delay_ms / 1e3 > LIMIT_S[key] / 2
        assert bool(warnings[key] & InputWarning.DELAY) is is_long, key
        assert not warnings[key] & InputWarning.CLOCK_STEP


@BOTH
@pytest.mark.parametrize("key", AGED)
@pytest.mark.parametrize("rate", [0.05, 0.5])
def test_row_04_a_queue_that_builds_up_is_a_delay(key: str, rate: float, period_s: float) -> None:
    """Each sample of one input takes longer than the one before: no clock, the others show it."""
    scene = Scene(period_s).drive()
    since = scene.now
    scene.inject(lambda data: [((scene.now - since) * rate, data)], key)
    noise_s = period_s + 0.025  # of a delay that is seen once a tick
    grown_s = (LIMIT_S[key] + noise_s) * (1.0 + rate) / (rate - 0.002)
    silent_within(scene, since, grown_s + bound(key, period_s), margin_s=5.0)
    assert scene.refused(key, SampleReason.DELAYED) > 0


@BOTH
@pytest.mark.parametrize("key", AGED)
def test_row_04_a_delay_beyond_the_limit_counts_as_lost(key: str, period_s: float) -> None:
    scene = Scene(period_s).drive()
    warnings = warned(scene)
    since = scene.inject(wire.delay(LIMIT_S[key] + period_s + 0.1), key)
    silent_within(scene, since, bound(key, period_s), margin_s=5.0)
    assert scene.refused(key, SampleReason.DELAYED) > 0
    recovers(scene, Reason.INPUT_STALE, settle_s=2.0)
    assert not warnings[key] & InputWarning.CLOCK_STEP


@BOTH
def test_row_05_of_a_burst_the_newest_counts(period_s: float) -> None:
    scene = Scene(period_s).drive()
    warnings = warned(scene)
    scene.inject(wire.bursts(8), "odometry", "steering", "acceleration")
    stays_active(scene, 10.0)
    assert not any(bits & InputWarning.CLOCK_STEP for bits in warnings.values())
    item = scene.input("odometry")
    assert item.superseded > item.accepted
    assert item.message.stamp.nanoseconds / 1e9 > scene.now - 8 * 0.025 - period_s


@BOTH
def test_row_05_jitter_is_counted(period_s: float, random: Random) -> None:
    scene = Scene(period_s).drive()
    warnings = warned(scene)
    scene.inject(wire.jitter(0.15, random))
    stays_active(scene, 10.0)
    assert not any(bits & InputWarning.CLOCK_STEP for bits in warnings.values())
    item = scene.input("odometry")
    assert item.overtaken + item.refused[SampleReason.OLDER] > 0


@BOTH
def test_row_06_duplicates_change_no_bit(period_s: float) -> None:
    twin, scene = Scene(period_s).drive(), Scene(period_s).drive()
    scene.inject(wire.duplicate(after_s=0.01))
    assert stays_active(scene, 10.0) == stays_active(twin, 10.0)
    counted = sum(
        item.refused[SampleReason.DUPLICATE] + item.superseded for item in scene.node.inputs.items
    )
    assert counted > sum(item.superseded for item in twin.node.inputs.items)


@BOTH
@pytest.mark.parametrize("key", AGED)
def test_row_06_a_replayed_message_is_no_sign_of_life(key: str, period_s: float) -> None:
    scene = Scene(period_s).drive()
    held = scene.wires[key].sent[0]
    since = scene.inject(wire.change(lambda _: held), key)
    silent_within(scene, since, bound(key, period_s))
    assert scene.refused(key, SampleReason.DUPLICATE) > 0
    recovers(scene, Reason.INPUT_STALE)


@BOTH
def test_row_07_reordered_messages_never_lead_back(period_s: float) -> None:
    scene = Scene(period_s).drive()
    for key in INPUTS:
        scene.inject(wire.swap(), key)
    stamps = []
    for _ in range(round(10.0 / period_s)):
        stays_active(scene, period_s)
        stamps.append(tuple(scene.input(key).message.stamp.nanoseconds for key in INPUTS))
    assert all(a <= b for x, y in pairwise(stamps) for a, b in zip(x, y, strict=True))
    for key in AGED:
        assert scene.input(key).overtaken + scene.refused(key, SampleReason.OLDER) > 0


@BOTH
@pytest.mark.parametrize("last", [Mode.STOP, Mode.AUTONOMOUS], ids=lambda mode: mode.name)
def test_row_07_a_mode_that_was_overtaken_does_not_count(period_s: float, last: Mode) -> None:
    """Of two modes in one tick the one that was said last, whichever arrives last."""
    scene = Scene(period_s).drive()
    scene.world._engage = False
    first = Mode.STOP if last is Mode.AUTONOMOUS else Mode.AUTONOMOUS
    scene.world.mode = last
    scene.run(1.0)
    for _ in range(3):
        scene.inject(wire.swap(), "operation_mode")
        for mode in (first, last):
            scene.world.mode = mode
            scene.main_compute.publish_vehicle()
            scene.idle(0.002)
        scene.run(4 * period_s)
        assert scene.input("operation_mode").message.mode == last
        driving = last is Mode.AUTONOMOUS
        assert scene.rows[-1].state is (State.ACTIVE if driving else State.READY)
    assert scene.input("operation_mode").overtaken == 3


@BOTH
def test_row_07_an_old_mode_that_comes_late_gives_no_autonomy(period_s: float) -> None:
    """AUTONOMOUS, then STOP; what was said first arrives some ticks after it."""
    scene = Scene(period_s).drive()
    scene.world._engage = False
    scene.disengage()
    assert scene.run(1.0)[-1].state is State.READY
    kept: list[bytes] = []
    scene.inject(wire.once(wire.keep(kept)), "operation_mode")
    for mode in (Mode.AUTONOMOUS, Mode.STOP):
        scene.world.mode = mode
        scene.main_compute.publish_vehicle()
        scene.idle(0.002)
    scene.run(1.0)
    scene.wires["operation_mode"].release(kept)
    assert {row.state for row in scene.run(1.0)} == {State.READY}
    assert scene.refused("operation_mode", SampleReason.OLDER) == 1


@BOTH
@pytest.mark.parametrize("stall_s", [0.2, 0.3])
def test_row_08_of_a_backlog_only_the_newest_is_used(period_s: float, stall_s: float) -> None:
    scene = Scene(period_s).drive()
    kept: dict[str, list[bytes]] = {key: [] for key in AGED}
    for key in AGED:
        scene.inject(wire.keep(kept[key]), key)
    scene.run(stall_s)
    accepted = {key: scene.input(key).accepted for key in AGED}
    for key in AGED:
        scene.wires[key].release(kept[key])
    scene.inject(wire.drop)
    row = scene.tick()
    assert (row.state, row.output) == (State.ACTIVE, "published")
    for key in AGED:
        assert scene.input(key).accepted == accepted[key] + bool(kept[key])
    scene.clear()
    stays_active(scene, 2.0)


@BOTH
def test_row_08_after_a_stall_of_the_island_no_backlog_is_used(period_s: float) -> None:
    """The messages of the time before wait in its queues; the vehicle stands when it goes on."""
    scene = Scene(period_s).drive()
    scene.inject(wire.drop)
    backlog = {key: scene.wires[key].sent[0] for key in AGED}
    accepted = {key: scene.input(key).accepted for key in AGED}
    scene.idle(5.0)
    for key in AGED:
        scene.wires[key].release([backlog[key]])
    rows = scene.run(1.0)
    assert rows[0].skipped > 0
    assert {(row.state, row.output) for row in rows} == {(State.INIT, "silent")}
    assert {key: scene.input(key).accepted for key in AGED} == accepted
    assert "begins anew" in scene.log_text
    scene.clear()
    rows = scene.run(0.6)
    assert (rows[-1].state, rows[0].speed) == (State.ACTIVE, 0.0)


@BOTH
def test_row_08_a_stalled_island_does_not_arm_itself_in_motion(period_s: float) -> None:
    scene = Scene(period_s).drive()
    since = scene.now
    scene.idle(0.8)
    row = scene.tick()
    assert (row.state, row.output) == (State.INIT, "silent")
    assert row.speed > 1.0
    silent_within(scene, since, 0.8)
    stays_latched(scene, Reason.STALLED)
    rearms(scene)
