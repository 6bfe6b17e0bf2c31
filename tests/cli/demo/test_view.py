# SPDX-License-Identifier: Apache-2.0
"""The live view and the plain lines show what is known at every stage."""

from __future__ import annotations

import io

import pytest
from rich.console import Console

from safety_island.cli.demo.canvas import ARROWS, DOWN, TARGET, TRAIL, UP, CourseMap
from safety_island.cli.demo.events import DemoState
from safety_island.cli.demo.show import PlainShow
from safety_island.cli.demo.text import milliseconds, plain_line, waiting_for
from safety_island.cli.demo.view import View
from safety_island.sim.courses import COURSES, load_course
from tests.cli.demo.samples import STATUS, TICK, WAITING


def drawn(state: DemoState, width: int = 100, height: int = 30, course: str = "s-curve") -> str:
    console = Console(file=io.StringIO(), width=width, force_terminal=False)
    view = View(load_course(course), "title", has_keys=True)
    with console.capture() as capture:
        console.print(view.draw(state, width, height))
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


@pytest.mark.parametrize(
    ("tick", "vehicle", "text"),
    [
        ({"state": "SILENT", "outcome": "FORBIDDEN"}, {"gate": "braking"}, "then key a to arm"),
        ({"state": "READY"}, {"gate": "ready", "operation_mode": "STOP"}, "key space to engage"),
        ({}, {}, None),
    ],
)
def test_a_disturbed_drive_says_how_it_goes_on(
    tick: dict[str, str], vehicle: dict[str, str], text: str | None
) -> None:
    state = DemoState(tick=TICK | tick, vehicle=STATUS | vehicle, was_acted_on=True)
    shown = drawn(state)
    assert text in shown if text else "waiting for" not in shown


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
        "ACTIVE",
        "guard passed",
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
@pytest.mark.parametrize("size", [(36, 4), (76, 9), (196, 40)])
def test_map_fits_and_follows_the_course(name: str, size: tuple[int, int]) -> None:
    course = load_course(name)
    course_map = CourseMap(course, *size)
    places = set()
    for percent in range(0, 101, 5):
        rows = course_map.draw((course.length * percent / 100, 0.0)).plain.split("\n")
        assert len(rows) <= size[1]
        assert max(map(len, rows)) <= size[0]
        (place,) = [
            (number, row.index(mark))
            for number, row in enumerate(rows)
            for mark in ARROWS
            if mark in row
        ]
        places.add(place)
    assert len(places) > 10


def test_map_shows_heading_target_and_trail() -> None:
    course = load_course("u-turn")
    course_map = CourseMap(course, 76, 9)
    seen = [
        next(mark for mark in course_map.draw((station, 0.0)).plain if mark in ARROWS)
        for station in (10.0, 101.0, 170.0)
    ]
    assert seen == ["→", "↑", "←"]
    assert TARGET in course_map.draw((10.0, 0.0), target=course.length).plain
    assert TARGET not in course_map.draw((10.0, 0.0)).plain
    trail = [(float(station), 0.0) for station in range(60)]
    drawn_trail = course_map.draw((60.0, 0.0), trail)
    assert TRAIL in {str(span.style) for span in drawn_trail.spans}
    assert TRAIL not in {str(span.style) for span in course_map.draw((60.0, 0.0)).spans}


def test_trail_lies_beside_the_path_where_the_vehicle_was_off_it() -> None:
    course_map = CourseMap(load_course("u-turn"), 76, 9)
    on, off = (course_map.draw((60.0, 0.0), [(50.0, error)]).plain for error in (0.0, 6.0))
    assert on != off


def test_climbs_and_descents_are_marked_and_their_height_is_drawn() -> None:
    hill, flat = (CourseMap(load_course(name), 76, 9) for name in ("hill", "s-curve"))
    assert flat.is_flat
    assert not hill.is_flat
    styles = {str(span.style) for span in hill.draw((0.0, 0.0)).spans}
    assert {UP, DOWN} <= styles
    rows = hill.profile(70.0, 40, 3).plain.split("\n")
    assert [len(row) for row in rows] == [40, 40, 40]
    assert rows[0].strip()  # the top of the hill reaches the top row
    assert rows[0].startswith(" ")  # and its foot does not
    assert "█" in rows[2]


FULL = DemoState(
    tick=TICK,
    vehicle=STATUS,
    trail=[(float(station), 0.02) for station in range(84)],
    messages=[
        f"bridge: message {number} of a length that no narrow window has" for number in "123"
    ],
)


@pytest.mark.parametrize("name", ["s-curve", "hill", "u-turn"])
@pytest.mark.parametrize("width", [40, 57, 80, 109, 120, 200, 320])
@pytest.mark.parametrize("height", [24, 50])
def test_layout_fills_the_width_of_the_window_and_fits(name: str, width: int, height: int) -> None:
    lines = drawn(FULL, width, height, name).splitlines()
    assert {len(line) for line in lines} == {width}
    assert len(lines) <= height - 1 or width < 80
    text = "\n".join(lines)
    for part in ("84 of 325 m", "7.81 of 8.00 m/s", "-0.031 m", "stop in 241 m", "+8.0 %"):
        assert part in text
    for part in ("DRIVE", "ACTIVE", "passed", "0.42 ms", "space: disengage", "q:"):
        assert part in text
    assert "contro…" not in text
    assert "input…" not in text
    assert any(arrow in text for arrow in ARROWS)


def test_a_larger_window_has_a_larger_map() -> None:
    dots = [
        sum(0x2800 < ord(character) < 0x2900 for character in drawn(FULL, width, 50, "u-turn"))
        for width in (40, 80, 200)
    ]
    assert dots[0] < dots[1] < dots[2]


def test_wide_and_low_window_has_the_figures_beside_the_map() -> None:
    (line,) = [line for line in drawn(FULL, 200, 24, "u-turn").splitlines() if "course" in line]
    assert any(0x2800 <= ord(character) < 0x2900 for character in line)


def test_guard_and_island_are_shown() -> None:
    tick = TICK | {"state": "SILENT", "guard": "CLAMPED", "guard_limits": ["JERK", "RATE"]}
    text = drawn(DemoState(tick=tick, vehicle=STATUS | {"gate": "braking"}))
    assert "SILENT" in text
    assert "guard JERK, RATE" in text


def test_keys_and_reactions_are_not_pushed_out_by_what_is_logged() -> None:
    state = DemoState(tick=TICK, vehicle=STATUS, messages=[f"bridge: {n}" for n in range(50)])
    state.add_event("key k: bridge killed")
    state.add_event("island SILENT after 0.57 s, bound 0.73 s", is_reaction=True)
    text = drawn(state)
    assert "  12.3 s  key k: bridge killed" in text
    assert "  12.3 s    island SILENT after 0.57 s, bound 0.73 s" in text
    assert "bridge: 49" in text


def test_a_warning_is_shown_without_its_head() -> None:
    line = "island: [WARN] [1796053292.550350] [SILENT INPUT_STALE] state SILENT: too old"
    text = drawn(DemoState(tick=TICK, vehicle=STATUS, messages=[line]))
    assert "island: WARN: state SILENT: too old" in text
