# SPDX-License-Identifier: Apache-2.0
"""What the keys do, and the reactions that are seen."""

from __future__ import annotations

from typing import Any

import pytest

from safety_island.cli.demo.actions import BUTTONS, HELP, Actions, Reactions, Recipes
from safety_island.cli.demo.child import Child
from safety_island.cli.demo.events import ARM, BRIDGE, SECOND_ISLAND, VEHICLE, DemoState
from safety_island.cli.parameters import read_parameters
from safety_island.sim.console import FREEZABLE
from tests.cli.demo.samples import STATUS, TICK


class FakeChild(Child):
    """A child that notes what it is told; it is never started."""

    def __init__(self, name: str) -> None:
        super().__init__(name, ())
        self.lines: list[str] = []

    def say(self, line: str) -> None:
        self.lines.append(line)

    def stand_still(self) -> None:
        self.lines.append("(stands still)")

    def go_on(self) -> None:
        self.lines.append("(goes on)")


class FakeSession:
    """What the keys need of a session, without processes."""

    def __init__(self) -> None:
        self.state = DemoState(vehicle=STATUS, tick=TICK)
        self.vehicle = FakeChild(VEHICLE)
        self.running: list[Child] = [FakeChild(BRIDGE), self.vehicle]
        self.done: list[str] = []

    def find(self, name: str) -> Child | None:
        return next((child for child in self.running if child.name == name), None)

    def add(self, child: Child) -> None:
        self.running.append(child)

    def drop(self, child: Child, *, kill: bool = False) -> None:
        self.done.append(f"{'kill' if kill else 'end'} {child.name}")
        self.running.remove(child)

    def end(self) -> None:
        self.done.append("end")

    def lift_limit(self) -> None:
        self.done.append("lift limit")


@pytest.fixture
def session() -> FakeSession:
    return FakeSession()


@pytest.fixture
def actions(session: FakeSession) -> Actions:
    recipes = Recipes(*(lambda name=name: FakeChild(name) for name in (BRIDGE, SECOND_ISLAND, ARM)))
    return Actions(session, recipes)


def texts(session: FakeSession) -> list[str]:
    return [event.text for event in session.state.events]


def test_every_key_of_the_help_acts_and_is_an_event(actions: Actions, session: FakeSession) -> None:
    for key in HELP:
        assert actions.press(key)
    assert len(session.state.events) == len(HELP)
    assert all(event.time_s == STATUS["time_s"] for event in session.state.events)
    assert not actions.press("x")
    assert len(session.state.events) == len(HELP)


def test_space_disengages_and_engages(actions: Actions, session: FakeSession) -> None:
    actions.press(" ")
    session.state.vehicle = STATUS | {"operation_mode": "STOP"}
    actions.press(" ")
    assert session.vehicle.lines == ["stay", "disengage", "engage"]
    assert texts(session) == [
        "key space: autonomous mode disengaged",
        "key space: autonomous mode engaged",
    ]


def test_k_kills_the_bridge_and_starts_it_anew(actions: Actions, session: FakeSession) -> None:
    actions.press("k")
    assert session.find(BRIDGE) is None
    assert "kill bridge" in session.done
    actions.press("k")
    assert session.find(BRIDGE) is not None
    assert texts(session) == ["key k: bridge killed", "key k: bridge started anew"]


def test_n_makes_the_odometry_nan_and_a_number_again(
    actions: Actions, session: FakeSession
) -> None:
    actions.press("n")
    actions.press("n")
    assert session.vehicle.lines == ["stay", "nan", "number"]


def test_f_freezes_one_topic_after_the_other(actions: Actions, session: FakeSession) -> None:
    for _ in range(4):
        actions.press("f")
    assert session.vehicle.lines == [
        "stay",
        "freeze trajectory",
        "thaw trajectory",
        "freeze odometry",
        "thaw odometry",
    ]


def test_2_starts_a_second_island_and_ends_it(actions: Actions, session: FakeSession) -> None:
    actions.press("2")
    assert session.find(SECOND_ISLAND) is not None
    actions.press("2")
    assert session.find(SECOND_ISLAND) is None
    assert "end second island" in session.done


def test_a_arms_and_is_no_fault(actions: Actions, session: FakeSession) -> None:
    actions.press("a")
    actions.press("a")
    assert [child.name for child in session.running].count(ARM) == 1
    assert session.vehicle.lines == []
    assert not session.state.was_acted_on


def test_a_fault_key_lifts_the_limit_once(actions: Actions, session: FakeSession) -> None:
    actions.press("n")
    actions.press("f")
    assert session.done == ["lift limit"]
    assert session.state.was_acted_on


def test_q_ends(actions: Actions, session: FakeSession) -> None:
    actions.press("q")
    assert session.done == ["end"]
    assert not session.state.was_acted_on


def reaction(tick: dict[str, Any], vehicle: dict[str, Any], after_s: float) -> list[str]:
    """The event lines of one change after a key."""
    state = DemoState(vehicle=STATUS, tick=TICK)
    reactions = Reactions(state, read_parameters([], 0.15).parameters)
    reactions.pressed(100.0)
    reactions.look(100.01)
    assert state.events == [], "nothing has changed yet"
    state.tick, state.vehicle = TICK | tick, STATUS | vehicle
    reactions.look(100.0 + after_s)
    reactions.look(100.2 + after_s)
    assert all(event.is_reaction for event in state.events)
    return [event.text for event in state.events]


def test_silence_is_told_with_its_time_and_its_bound() -> None:
    stale = {"state": "SILENT", "reason": "INPUT_STALE", "subject": "odometry"}
    assert reaction(stale, {}, 0.61) == [
        "island SILENT after 0.61 s, bound 0.73 s: odometry is older than its limit"
    ]


def test_bound_follows_the_input() -> None:
    (text,) = reaction(
        {"state": "SILENT", "reason": "INPUT_STALE", "subject": "trajectory"}, {}, 1.0
    )
    assert "bound 1.13 s: trajectory" in text


def test_loss_of_all_inputs_is_bound_by_the_first() -> None:
    (text,) = reaction({"state": "SILENT", "reason": "PARTITION", "subject": None}, {}, 0.6)
    assert text == ("island SILENT after 0.60 s, bound 0.73 s: every input is older than its limit")


def test_no_bound_is_claimed_where_none_is_known() -> None:
    (text,) = reaction({"state": "SILENT", "reason": "SECOND_ISLAND"}, {}, 2.0)
    assert "bound" not in text
    assert text.startswith("island SILENT after 2.00 s: another island")


def test_recovery_and_the_vehicle_are_told() -> None:
    assert reaction({}, {"gate": "braking"}, 0.8) == ["vehicle braking after 0.80 s"]
    assert reaction({"state": "READY"}, {}, 0.2) == ["island READY after 0.20 s"]


def test_changes_long_after_a_key_are_no_reactions() -> None:
    assert reaction({"state": "SILENT", "reason": "PARTITION"}, {}, 31.0) == []


def active(actions: Actions) -> list[str]:
    return [str(button["key"]) for button in actions.buttons() if button["active"]]


@pytest.mark.parametrize("name", [name for name in BUTTONS if name not in ("clear", "arm", "mode")])
def test_each_fault_of_the_page_lasts_until_it_is_pressed_again(
    name: str, actions: Actions, session: FakeSession
) -> None:
    assert active(actions) == []
    assert actions.click(name)
    assert active(actions) == [name]
    assert session.state.was_acted_on
    assert actions.click(name)
    assert active(actions) == []
    assert all(text.startswith("page: ") for text in texts(session))


def test_every_button_acts_and_nothing_else_does(actions: Actions, session: FakeSession) -> None:
    for name in BUTTONS:
        assert actions.click(name)
    assert len(session.state.events) == len(BUTTONS)
    for name in ("q", "k", "", "freeze control", "still island"):
        assert not actions.click(name)
    assert len(session.state.events) == len(BUTTONS)


def test_clearing_takes_every_fault_away(actions: Actions, session: FakeSession) -> None:
    actions.click("clear")
    assert texts(session) == ["page: there is no fault to clear"]
    faults = [name for name in BUTTONS if name not in ("clear", "arm", "mode")]
    for name in faults:
        actions.click(name)
    assert session.find(BRIDGE) is None
    actions.click("clear")
    assert active(actions) == []
    assert session.find(BRIDGE) is not None
    assert session.find(SECOND_ISLAND) is None
    thawed = {f"thaw {topic}" for topic in FREEZABLE}
    assert thawed | {"number", "return", "(goes on)"} <= set(session.vehicle.lines)


def test_what_stands_still_goes_on(actions: Actions, session: FakeSession) -> None:
    actions.click("still main-compute")
    actions.click("still main-compute")
    assert session.vehicle.lines == ["stay", "(stands still)", "(goes on)"]


def test_a_key_thaws_what_a_button_froze(actions: Actions, session: FakeSession) -> None:
    actions.click("freeze steering")
    actions.press("f")
    assert active(actions) == []
