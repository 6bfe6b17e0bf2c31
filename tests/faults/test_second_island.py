# SPDX-License-Identifier: Apache-2.0
"""Row 71 of the fault catalogue: two islands on one domain."""

from __future__ import annotations

from safety_island.dds import topics
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.node.memory import MemoryDomain
from tests.faults.checks import (
    BOTH,
    rearms,
    silent_within,
    stays_active,
    stays_latched,
)
from tests.faults.scene import SLOW, Scene

SILENT_POLICY = {"gate.second_publisher": "silent"}


class DiscoveredDomain(MemoryDomain):
    """A domain in which the others are found within the time that the parameters give."""

    needs_discovery = True


@BOTH
def test_row_71_a_second_island_does_not_arm(period_s: float) -> None:
    """The first goes on and tells; the newcomer sends nothing as long as the first lives."""
    scene = Scene(period_s, domain=DiscoveredDomain).drive()
    newcomer = scene.new_node()
    own: list[int] = []
    scene.node.observers.append(lambda report: own.append(newcomer.tick().published))
    stays_active(scene, 10.0)
    assert not any(own)
    life = newcomer.life_cycle.life
    assert (life.state, life.reason) == (State.INIT, Reason.SECOND_ISLAND)
    assert "another publisher is on /control/trajectory_follower/control_cmd" in scene.log_text


def test_row_71_the_newcomer_goes_on_when_the_first_has_left() -> None:
    """Not by itself while the vehicle moves."""
    scene = Scene(domain=DiscoveredDomain).drive()
    newcomer = scene.new_node()
    for _ in range(20):
        scene.tick()
        newcomer.tick()
    scene.node.sender.outputs[0]._publisher.close()  # type: ignore[attr-defined]
    assert scene.world.plant.speed > 1.0
    scene.idle(SLOW)
    report = newcomer.tick()
    assert (report.life.state, report.published) == (State.SILENT, False)
    assert report.life.reason is Reason.RESTARTED_WHILE_MOVING


def test_row_71_neither_after_autonomous_mode_was_engaged_anew() -> None:
    """That was meant for the first one."""
    scene = Scene(domain=DiscoveredDomain).drive()
    newcomer = scene.new_node()
    for engages in (True, False, True):
        scene.world._engage = engages
        if not engages:
            scene.disengage()
        for _ in range(10):
            scene.tick()
            newcomer.tick()
        assert newcomer.inputs.disengaged is (Reason.NONE if engages else Reason.NOT_AUTONOMOUS)
    assert scene.node.life_cycle.state is State.ACTIVE
    scene.node.sender.outputs[0]._publisher.close()  # type: ignore[attr-defined]
    assert scene.world.plant.speed > 1.0
    scene.idle(SLOW)
    assert newcomer.tick().life.reason is Reason.RESTARTED_WHILE_MOVING


def test_row_73_publishers_of_the_command_that_flap_end_the_output() -> None:
    scene = Scene().drive()
    entry = topics.CONTROL
    for _ in range(scene.parameters.gate.writer_changes + 1):
        scene.domain.publisher(entry.name, entry.type_name, entry.qos).close()
        scene.tick()
        publisher = scene.domain.publisher(entry.name, entry.type_name, entry.qos)
        scene.tick()
        publisher.close()
    first = next(row for row in scene.rows if row.state is State.SILENT)
    assert first.reason is Reason.WRITER_FLAPPING
    scene.run(1.5)
    stays_latched(scene, Reason.WRITER_FLAPPING)
    rearms(scene)


def test_row_73_one_that_comes_and_goes_is_none_of_that() -> None:
    scene = Scene().drive()
    entry = topics.CONTROL
    publisher = scene.domain.publisher(entry.name, entry.type_name, entry.qos)
    stays_active(scene, 1.0)
    publisher.close()
    stays_active(scene, 1.0)


def test_row_71_nobody_sends_before_it_has_looked_around() -> None:
    scene = Scene(domain=DiscoveredDomain)
    wait_s = scene.parameters.life_cycle.discovery_time
    rows = scene.run(wait_s - SLOW)
    assert {(row.state, row.reason) for row in rows} == {(State.INIT, Reason.DISCOVERING)}
    scene.run(1.0)
    stays_active(scene, 1.0)


def test_row_71_the_first_goes_silent_where_that_is_the_policy() -> None:
    scene = Scene(domain=DiscoveredDomain, overrides=SILENT_POLICY).drive()
    newcomer = scene.new_node()
    first = silent_within(scene, scene.now, SLOW)
    assert first.reason is Reason.SECOND_PUBLISHER
    newcomer.sender.outputs[0]._publisher.close()  # type: ignore[attr-defined]
    stays_latched(scene, Reason.SECOND_PUBLISHER)
    rearms(scene)
