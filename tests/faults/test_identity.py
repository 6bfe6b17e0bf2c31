# SPDX-License-Identifier: Apache-2.0
"""Rows 72 to 76 of the fault catalogue: publishers that are too many, new, or gone."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from safety_island.cli.main import main
from safety_island.control.status import Mode
from safety_island.dds import topics
from safety_island.input_gate.reason import SampleReason
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from tests.faults import wire
from tests.faults.checks import (
    BOTH,
    bound,
    rearms,
    silent_within,
    stays_active,
    stays_latched,
    subject,
)
from tests.faults.scene import AGED, EPOCH_NS, INPUTS, SLOW, Scene

EACH = pytest.mark.parametrize("key", INPUTS)


SILENT_POLICY = {"gate.second_publisher": "silent"}


def spoof(scene: Scene, key: str) -> Callable[[], None]:
    """Let a second writer say the same again and again, under stamps that are ahead."""
    intruder = scene.wires[key].intrude()
    writes = [True]

    def write() -> None:
        if writes[0]:
            ahead = scene.remote_clock.wall_ns() + 10**9
            ((_, data),) = wire.stamped(ahead // 10**9, ahead % 10**9)(scene.wires[key].sent[0])
            intruder.write(data)
            scene.clock.call_at(scene.clock.monotonic_ns() + 4_000_000, write)

    def leave() -> None:
        writes[0] = False
        intruder.close()

    write()
    return leave


@BOTH
@EACH
def test_row_72_the_first_publisher_is_kept_and_the_second_told(key: str, period_s: float) -> None:
    """However much the second one says, no bit of a command changes."""
    twin, scene = Scene(period_s).drive(), Scene(period_s).drive()
    spoof(scene, key)
    assert stays_active(scene, 3.0) == stays_active(twin, 3.0)
    assert scene.refused(key, SampleReason.OTHER_PUBLISHER) > 100
    assert scene.input(key).writers.others == 1
    assert scene.input(key).writers.owner == scene.wires[key].guid
    assert "has 2 publishers" in scene.log_text


def test_row_72_a_flood_does_not_hide_that_somebody_disengaged() -> None:
    scene = Scene().drive()
    spoof(scene, "operation_mode")
    scene.world._engage = False
    scene.disengage()
    assert scene.run(0.3)[-1].state is State.READY


@EACH
def test_row_72_it_goes_silent_where_that_is_the_policy(key: str) -> None:
    scene = Scene(overrides=SILENT_POLICY).drive()
    leave = spoof(scene, key)
    first = silent_within(scene, scene.now, SLOW)
    assert (first.reason, subject(first)) == (Reason.SECOND_PUBLISHER, key)
    leave()
    stays_latched(scene, Reason.SECOND_PUBLISHER)
    rearms(scene)


def test_row_72_the_second_is_taken_when_the_first_is_gone() -> None:
    scene = Scene().drive()
    spare = scene.wires["steering"].intrude()
    stays_active(scene, 1.0)
    scene.inject(wire.divert(spare.write), "steering")
    scene.wires["steering"].stop()
    stays_active(scene, 3.0)
    assert scene.input("steering").writers.owner == spare.guid


@BOTH
@pytest.mark.parametrize("key", AGED)
def test_row_73_a_publisher_that_flaps_ends_the_output(key: str, period_s: float) -> None:
    scene = Scene(period_s).drive()
    flapping = [True]

    def flap() -> None:
        if flapping[0]:
            scene.wires[key].restart()
            scene.clock.call_at(scene.clock.monotonic_ns() + 100_000_000, flap)

    since = scene.now
    flap()
    first = silent_within(scene, since, 1.0)
    assert (first.state, first.reason) == (State.SILENT, Reason.WRITER_FLAPPING)
    assert subject(first) == key
    flapping[0] = False
    scene.run(1.5)
    stays_latched(scene, Reason.WRITER_FLAPPING)
    rearms(scene)


@pytest.mark.parametrize("key", AGED)
def test_row_73_one_restart_of_a_publisher_is_none_of_that(key: str) -> None:
    scene = Scene().drive()
    scene.wires[key].restart()
    stays_active(scene, 3.0)


@BOTH
def test_row_74_a_participant_that_crashed_is_a_partition(period_s: float) -> None:
    """Its lease is over, so all its writers go at once; live: tests of the demo."""
    scene = Scene(period_s).drive()
    since = scene.now
    for key in INPUTS:
        scene.wires[key].stop()
    first = scene.tick()
    assert (first.state, first.reason) == (State.READY, Reason.MODE_WRITER_GONE)
    silent_within(scene, since, bound("odometry", period_s))
    assert scene.rows[-1].state is State.SILENT
    assert scene.node.life_cycle.life.cause is Reason.INPUT_STALE


@BOTH
def test_row_75_after_a_restart_of_the_bridge_no_old_sample_counts(period_s: float) -> None:
    """Its new writers begin with what the old ones had said last; nobody drives on by himself."""
    scene = Scene(period_s).drive()
    old = {key: scene.wires[key].sent[0] for key in AGED}
    for key in INPUTS:
        scene.wires[key].stop()
    scene.run(2.0)
    accepted = {key: scene.input(key).accepted for key in AGED}
    scene.inject(wire.drop)
    for key in INPUTS:
        scene.wires[key].restart()
    for key in AGED:
        scene.wires[key].release([old[key]])
    assert {row.output for row in scene.run(1.0)} == {"silent"}
    assert {key: scene.input(key).accepted for key in AGED} == accepted
    scene.clear()
    scene.main_compute._told_mode = None
    scene.run(1.0)
    stays_latched(scene, Reason.INPUT_STALE)
    rearms(scene)


@BOTH
def test_row_75_a_restart_that_loses_no_input_is_driven_over(period_s: float) -> None:
    scene = Scene(period_s).drive()
    for key in INPUTS:
        scene.wires[key].stop()
    rows = scene.run(2 * period_s)
    assert {(row.state, row.reason) for row in rows} == {(State.READY, Reason.MODE_WRITER_GONE)}
    for key in INPUTS:
        scene.wires[key].restart()
    scene.main_compute._told_mode = None
    scene.run(max(0.05, period_s))
    stays_active(scene, 2.0)


@BOTH
def test_row_75_what_was_held_up_is_not_taken_for_another_clock(period_s: float) -> None:
    """A new writer begins with what was said meanwhile: newer than all before, and old."""
    scene = Scene(period_s).drive()
    for key in INPUTS:
        scene.wires[key].stop()
    kept: dict[str, list[bytes]] = {key: [] for key in AGED}
    for key in AGED:
        scene.inject(wire.keep(kept[key]), key)
    scene.run(1.0)
    scene.inject(wire.drop)
    scene.run(3.0)
    accepted = {key: scene.input(key).accepted for key in AGED}
    for key in INPUTS:
        scene.wires[key].restart()
    for key in AGED:
        scene.wires[key].release(kept[key])
    scene.run(1.0)
    for key in AGED:
        assert scene.input(key).accepted == accepted[key]
        assert scene.refused(key, SampleReason.DELAYED) > 0


@BOTH
@pytest.mark.parametrize("skew_ms", [-60_000, -3000, -1500, -400, 400, 60_000])
def test_row_75_a_new_main_compute_may_have_another_clock(period_s: float, skew_ms: int) -> None:
    """Its stamps lie before the old ones, or after them, as of samples that were held up for long.

    It is heard within half the age limit and two periods of its own.
    """
    scene = Scene(period_s).drive()
    for key in INPUTS:
        scene.wires[key].stop()
    scene.run(2.0)
    scene.remote_clock.set_wall_offset_ns(EPOCH_NS + skew_ms * 1_000_000)
    accepted = {key: scene.input(key).accepted for key in AGED}
    for key in INPUTS:
        scene.wires[key].restart()
    scene.main_compute._told_mode = None
    scene.run(0.45 + 0.2 + period_s)
    assert all(scene.input(key).accepted > accepted[key] for key in AGED)
    rearms(scene)  # its inputs were lost, and nobody had left autonomous mode


@BOTH
@pytest.mark.parametrize("per_tick", [1, 3, 10])
def test_row_81_a_mode_delivered_again_stays_what_it_was(period_s: float, per_tick: int) -> None:
    """The match was lost and renewed; the history comes oldest first, over several ticks."""
    scene = Scene(period_s).drive()
    scene.world._engage = False
    history: list[bytes] = []
    for mode in (Mode.STOP, Mode.AUTONOMOUS) * 4 + (Mode.STOP,):
        scene.world.mode = mode
        scene.main_compute.publish_vehicle()
        history += scene.wires["operation_mode"].sent
        scene.run(2 * period_s)
    assert scene.rows[-1].state is State.READY
    for _ in range(2):
        rest = list(history)
        while rest:
            scene.wires["operation_mode"].release(rest[:per_tick])
            del rest[:per_tick]
            assert scene.tick().state is State.READY
    scene.world.mode = Mode.AUTONOMOUS
    scene.main_compute.publish_vehicle()
    assert scene.run(2 * period_s)[-1].state is State.ACTIVE


@BOTH
def test_row_81_a_publisher_that_was_out_of_sight_for_a_while(period_s: float) -> None:
    """Its lease lapsed, and it is there again: what it said last counts, and nothing older."""
    scene = Scene(period_s).drive()
    scene.world._engage = False
    engaged = scene.wires["operation_mode"].sent[0]
    scene.disengage()
    assert scene.run(1.0)[-1].state is State.READY
    stopped = scene.wires["operation_mode"].sent[0]
    topic = scene.domain._topics[topics.OPERATION_MODE.name]
    writers = topic.writers
    for alive in (frozenset[bytes](), writers):
        topic.writers = alive
        scene.domain._changes += 1
        scene.tick()
    for data in (engaged, stopped):
        scene.wires["operation_mode"].release([data])
        row = scene.tick()
        assert (row.state, row.reason) == (State.READY, Reason.NOT_AUTONOMOUS)


@BOTH
@EACH
@pytest.mark.parametrize("rate_hz", [1000, 10_000])
def test_row_82_a_flood_leaves_the_owner_its_room(key: str, period_s: float, rate_hz: int) -> None:
    """Not one sample of the owner is pushed out, and none of the flood is looked at."""
    twin, scene = Scene(period_s).drive(), Scene(period_s).drive()
    intruder = scene.wires[key].intrude()
    data = scene.wires[key].sent[0]

    def flood() -> None:
        for _ in range(rate_hz // 1000):
            intruder.write(data)
        scene.clock.call_at(scene.clock.monotonic_ns() + 1_000_000, flood)

    flood()
    assert stays_active(scene, 1.5) == stays_active(twin, 1.5)
    item, other = scene.input(key), twin.input(key)
    assert item.subscription.received == other.subscription.received
    assert (item.accepted, item.superseded) == (other.accepted, other.superseded)
    assert item.refused[SampleReason.OTHER_PUBLISHER] > rate_hz
    scene.world._engage = False
    scene.disengage()
    assert scene.run(2 * max(period_s, 0.03))[-1].state is State.READY


def test_row_76_a_bridge_that_closes_a_loop_does_not_start(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Through a third domain; every shape of loop: tests/bridge/test_routes.py."""
    path = tmp_path / "loop.yaml"
    entry = "  {0}: {{type: std_msgs/msg/Header, from_domain: {1}, to_domain: {2}, remap: {3}}}\n"
    steps = [entry.format(*step) for step in (("a", 1, 2, "b"), ("b", 2, 3, "c"), ("c", 3, 1, "a"))]
    path.write_text("topics:\n" + "".join(steps))
    assert main(["bridge", str(path)]) == 2
    told = capsys.readouterr().err
    assert f"{path}:4: /c domain 3 -> 1 as /a closes a loop with" in told
