"""The live view and the plain lines show what is known at every stage."""

from __future__ import annotations

import io

import pytest
from rich.console import Console

from safety_island.cli.demo.canvas import CourseMap
from safety_island.cli.demo.events import DemoState
from safety_island.cli.demo.show import PlainShow
from safety_island.cli.demo.text import milliseconds, plain_line, waiting_for
from safety_island.cli.demo.view import COLUMNS, ROWS, View
from safety_island.sim.courses import COURSES, load_course
from tests.cli.demo.samples import STATUS, TICK, WAITING


def drawn(state: DemoState) -> str:
    console = Console(file=io.StringIO(), width=100, force_terminal=False)
    with console.capture() as capture:
        console.print(View(load_course("s-curve"), "title").draw(state))
    return capture.get()


@pytest.mark.parametrize(
    ("state", "text"),
    [
        (DemoState(), "the island to start"),
        (DemoState(tick=WAITING), "the main compute to start"),
        (DemoState(tick=WAITING, vehicle=STATUS | {"gate": "waiting"}), "odometry"),
        (DemoState(tick=TICK, vehicle=STATUS | {"gate": "ready"}), "the vehicle to take commands"),
    ],
)
def test_start_says_what_it_waits_for(state: DemoState, text: str) -> None:
    assert waiting_for(state) == text
    assert text in drawn(state)


def test_view_shows_the_figures() -> None:
    text = drawn(DemoState(tick=TICK, vehicle=STATUS, messages=["bridge: hello"]))
    for part in (
        "84 of 325 m",
        "7.81 of 8.00 m/s",
        "-0.031 m",
        "DRIVE",
        "0.42 ms",
        "odometry 11 ms",
        "●",
        "bridge: hello",
    ):
        assert part in text
    assert "waiting for" not in text


def test_failed_mpc_is_shown() -> None:
    tick = TICK | {"mpc_status": "TOO_FAR"}
    assert "DRIVE, MPC TOO_FAR" in drawn(DemoState(tick=tick, vehicle=STATUS))


def test_plain_line() -> None:
    line = plain_line(DemoState(tick=TICK, vehicle=STATUS))
    assert line == (
        "  12.3 s    84.2 of 325 m   7.81 of  8.00 m/s  lateral -0.031 m  DRIVE"
        "  tick 0.42 ms  oldest input 60 ms"
    )


def test_plain_show_prints_messages_at_once_and_a_line_a_second() -> None:
    stream = io.StringIO()
    show = PlainShow(stream)
    state = DemoState()
    show(state)
    state.messages.append("island: hello")
    show(state)
    show(state)
    assert stream.getvalue() == "waiting for the island to start\nisland: hello\n"


@pytest.mark.parametrize(
    ("value", "text"), [(None, "-"), (0.0004, "0.40 ms"), (0.0123, "12 ms"), (1.5, "1500 ms")]
)
def test_milliseconds(value: float | None, text: str) -> None:
    assert milliseconds(value) == text


@pytest.mark.parametrize("name", COURSES)
def test_map_fits_and_follows_the_course(name: str) -> None:
    course = load_course(name)
    course_map = CourseMap(course, COLUMNS, ROWS)
    places = []
    for percent in range(0, 101, 5):
        rows, row, column = course_map.rows(course.length * percent / 100)
        assert rows[row][column] != "\u2800", "the marker stands on the path"
        places.append((row, column))
    assert len(rows) <= ROWS
    assert max(map(len, rows)) <= COLUMNS
    assert len(set(places)) > 10
