# SPDX-License-Identifier: Apache-2.0
"""What the demo tells its page."""

from __future__ import annotations

import json
from typing import Any

from safety_island.cli.demo.events import PAGE, VEHICLE
from safety_island.cli.demo.page import PageLines
from tests.cli.demo.samples import TICK
from tests.cli.demo.test_actions import FakeChild, FakeSession


class Scene:
    """A demo with a page that notes what it is told."""

    def __init__(self) -> None:
        self.session = FakeSession()
        self.page = FakeChild(PAGE)
        self.session.running.append(self.page)
        self.buttons: list[dict[str, object]] = [{"key": "nan", "active": False}]
        self.lines = PageLines(self.session, lambda: [dict(button) for button in self.buttons])

    def told(self) -> list[dict[str, Any]]:
        """Return what is told by one look."""
        self.page.lines.clear()
        self.lines.look()
        return [json.loads(line) for line in self.page.lines]


def served() -> Scene:
    scene = Scene()
    event = {"event": "address", "address": "http://127.0.0.1:8140/#t", "port": 8140}
    scene.session.state.update(PAGE, event)
    return scene


def test_nothing_is_told_before_there_is_an_address() -> None:
    scene = Scene()
    assert scene.told() == []
    assert "the page: http://127.0.0.1:8140/#t" in served().session.state.messages


def test_buttons_are_told_at_first_and_when_they_change() -> None:
    scene = served()
    assert scene.told() == [{"event": "buttons", "buttons": scene.buttons}]
    assert scene.told() == []
    scene.buttons[0]["active"] = True
    assert scene.told() == [{"event": "buttons", "buttons": scene.buttons}]


def test_events_become_marks_once() -> None:
    scene = served()
    scene.told()
    scene.session.state.add_event("page: bridge killed")
    scene.session.state.add_event("vehicle braking after 0.5 s", is_reaction=True)
    assert [(line["of"], line["text"]) for line in scene.told()] == [
        ("fault", "page: bridge killed"),
        ("reaction", "vehicle braking after 0.5 s"),
    ]
    assert scene.told() == []


def test_can_frames_are_told_when_there_are_new_ones() -> None:
    scene = served()
    scene.told()
    scene.session.state.tick = TICK | {"can": {"frames": ["123#00"]}}
    assert scene.told() == [{"event": "can", "can": {"frames": ["123#00"]}}]
    assert scene.told() == []


def test_a_button_that_is_pressed_waits_for_the_demo() -> None:
    scene = served()
    scene.session.state.update(PAGE, {"event": "press", "key": "nan"})
    assert scene.session.state.pressed == ["nan"]


def test_a_page_that_has_ended_is_told_nothing() -> None:
    scene = served()
    scene.session.running.remove(scene.page)
    scene.session.state.add_event("page: bridge killed")
    assert scene.told() == []
    assert scene.session.find(VEHICLE) is not None
