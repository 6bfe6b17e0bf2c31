# SPDX-License-Identifier: Apache-2.0
"""The live view of the demo in a terminal, laid out for the size of its window."""

from __future__ import annotations

import re

from rich.console import Group, RenderableType
from rich.panel import Panel
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from safety_island.cli.demo.actions import HELP
from safety_island.cli.demo.canvas import CourseMap
from safety_island.cli.demo.events import DemoState
from safety_island.cli.demo.text import (
    can_command,
    can_number,
    command,
    controller,
    event_line,
    guard,
    island,
    milliseconds,
    slope,
    target,
    waiting_for,
)
from safety_island.sim.courses import Course
from safety_island.sim.metrics import MAX_LATERAL_ERROR

_LOG_HEAD = re.compile(r"\[([A-Z]+)\] \[[\d.]+\] \[[^]]*\] ")

NARROWEST = 40
"""Columns for which the view is made at least; a narrower window crops it."""
WIDE = 110
"""Columns from which on map and figures may stand side by side, when the map is larger so."""
FIGURES = 64
"""Columns of the figures beside the map."""
FRAME = 4
"""Columns of the frame and its padding."""
TEXTS = 38
"""Columns that a row of figures needs beside its bar."""
SMALLEST_BAR, LARGEST_BAR = 18, 60
LARGEST_PROFILE = 8
"""Rows for the height of the road."""
MOST_MAPS = 8
"""That are kept, for the sizes that a view switches between."""
FEWEST_ROWS = 4
"""Of the map."""
SCALE = 0.5
"""Lateral error [m] at either end of its scale."""


class View:
    """Draws a state for a size; holds nothing but maps of the course."""

    def __init__(self, course: Course, title: str, *, has_keys: bool = False) -> None:
        self._course = course
        self._title = title
        self._help = "  ".join(f"{'space' if key == ' ' else key}: {what}" for key, what in _KEYS)
        self._has_keys = has_keys
        self._maps: dict[tuple[int, int], CourseMap] = {}

    def draw(self, state: DemoState, width: int = 80, height: int = 30) -> RenderableType:
        """Return the whole view for a window of that many columns and rows."""
        width = max(width, NARROWEST)
        inner = width - FRAME
        head, below = _head(state), self._below(state, inner, 7 if height >= 36 else 3)
        left = height - 3 - len(head) - _rows(below, inner)  # the frame, the row of the cursor
        figures = _figures(state, inner)
        size = inner, max(left - figures.row_count - 1, FEWEST_ROWS)
        beside = inner - FIGURES - 2, max(left, FEWEST_ROWS)
        if width >= WIDE and self._map_of(beside).scale < self._map_of(size).scale:
            table = Table.grid(padding=(0, 2))
            table.add_column(width=beside[0], no_wrap=True, overflow="crop")
            table.add_column(width=FIGURES)
            table.add_row(Group(*self._road(state, beside)), _figures(state, FIGURES))
            body: list[RenderableType] = [*head, table]
        else:
            body = [*head, *self._road(state, size), Text(), figures]
        return Panel(Group(*body, *below), title=self._title, width=width)

    def _road(self, state: DemoState, size: tuple[int, int]) -> list[Text]:
        """The map with the vehicle on it, and the height of the road when it has slopes."""
        columns, rows = size
        course_map = self._map_of(size)
        if not course_map.is_flat and rows > FEWEST_ROWS:
            course_map = self._map_of((columns, rows - 1))
        spare = max(1, min(rows - course_map.height, LARGEST_PROFILE))
        vehicle = state.vehicle
        station = float(vehicle.get("station", 0.0))
        place = station, float(vehicle.get("lateral_error", 0.0))
        parts = [course_map.draw(place, state.trail, vehicle.get("stop_station"))]
        if not course_map.is_flat:
            parts.append(course_map.profile(station, columns, spare))
        return parts

    def _map_of(self, size: tuple[int, int]) -> CourseMap:
        if size not in self._maps:
            if len(self._maps) >= MOST_MAPS:
                self._maps.clear()
            self._maps[size] = CourseMap(self._course, *size)
        return self._maps[size]

    def _below(self, state: DemoState, inner: int, lines: int) -> list[Text]:
        """Keys and reactions, what was logged last, and what the keys do."""
        events = [event_line(event) for event in state.events[-lines:]]
        logged = [_LOG_HEAD.sub(r"\1: ", text) for text in state.messages[-min(lines, 4) :]]
        parts = []
        for texts, style in ((events, "yellow"), (logged, "dim")):
            if texts:
                parts.append(Text())
            parts += [Text(text, style, no_wrap=True, overflow="ellipsis") for text in texts]
        if self._has_keys:
            parts += [Text(), Text(self._help, style="italic")]
        if state.page:
            parts.append(Text(f"page: {state.page}", style="bold", no_wrap=True))
        return parts


_KEYS = tuple(HELP.items())


def _rows(texts: list[Text], inner: int) -> int:
    """Rows that texts take in so many columns."""
    return sum(1 if text.no_wrap else max(1, -(-len(text) // (inner - 8))) for text in texts)


def _head(state: DemoState) -> list[Text]:
    """What is waited for while the vehicle does not obey the island."""
    if state.is_driving:
        return []
    text = Text.assemble(("waiting for  ", "bold"), waiting_for(state))
    text.no_wrap, text.overflow = True, "ellipsis"
    return [text]


def _figures(state: DemoState, inner: int) -> Table:
    bar = inner - TEXTS
    return _with_bars(state, min(bar, LARGEST_BAR)) if bar >= SMALLEST_BAR else _without_bars(state)


def _grid(columns: int) -> Table:
    table = Table.grid(padding=(0, 2))
    table.add_column(style="bold", no_wrap=True)
    for _ in range(columns - 1):
        table.add_column(no_wrap=True, overflow="ellipsis")
    return table


def _with_bars(state: DemoState, bar: int) -> Table:
    table = _grid(3)
    vehicle = state.vehicle
    if vehicle:
        place, length = float(vehicle["station"]), float(vehicle["length"])
        table.add_row("course", _bar(place, length, bar), f"{place:.0f} of {length:.0f} m")
        speed, wanted = float(vehicle["speed"]), float(vehicle["target_speed"])
        table.add_row("speed", _bar(speed, max(wanted, speed), bar), _speed(state))
        error = float(vehicle["lateral_error"])
        table.add_row("lateral", _offset(error, bar), f"{error:+.3f} m")
        table.add_row("target", target(state), slope(state))
    table.add_row("controller", _bold(controller(state)), command(state))
    table.add_row("island", island(state), guard(state))
    if frames := can_command(state):
        table.add_row("CAN frames", Text(frames), can_number(state))
    late = milliseconds(state.tick.get("lateness_s"))
    table.add_row("tick", milliseconds(state.tick.get("tick_s")), f"woken {late} late")
    for label, ages in zip(("input ages", ""), _ages(state), strict=True):
        table.add_row(label, *ages)
    return table


def _without_bars(state: DemoState) -> Table:
    """The same as texts alone, for a narrow window."""
    table = _grid(2)
    vehicle = state.vehicle
    if vehicle:
        table.add_row("course", f"{vehicle['station']:.0f} of {vehicle['length']:.0f} m")
        table.add_row("speed", _speed(state))
        table.add_row("lateral", f"{vehicle['lateral_error']:+.3f} m")
        table.add_row("target", target(state))
        table.add_row("slope", slope(state).removeprefix("slope "))
    table.add_row("controller", _bold(controller(state)))
    table.add_row("", command(state))
    table.add_row("island", island(state))
    table.add_row("guard", guard(state).removeprefix("guard "))
    if frames := can_command(state):
        table.add_row("CAN frames", frames)
    table.add_row("tick", milliseconds(state.tick.get("tick_s")))
    return table


def _speed(state: DemoState) -> str:
    return f"{state.vehicle['speed']:.2f} of {state.vehicle['target_speed']:.2f} m/s"


def _bar(value: float, total: float, width: int) -> ProgressBar:
    return ProgressBar(total=max(total, 1e-3), completed=max(value, 0.0), width=width)


def _offset(error: float, width: int) -> Text:
    """The road across, seen in driving direction, with the limits and the vehicle marked."""
    middle = (width - 1) // 2
    cells = ["─"] * (2 * middle + 1)
    for limit in (-MAX_LATERAL_ERROR, MAX_LATERAL_ERROR):
        cells[middle - round(limit / SCALE * middle)] = "┆"
    cells[middle] = "┼"
    at = middle - round(max(-1.0, min(1.0, error / SCALE)) * middle)
    good = abs(error) < MAX_LATERAL_ERROR
    return Text.assemble(
        "".join(cells[:at]), ("●", "bold green" if good else "bold red"), "".join(cells[at + 1 :])
    )


def _bold(text: str) -> Text:
    return Text(text, style="bold green" if text in ("DRIVE", "STOPPING", "STOPPED") else "yellow")


def _ages(state: DemoState) -> tuple[tuple[str, str], tuple[str, str]]:
    ages = state.tick.get("ages_s", {})
    shown = [f"{name} {milliseconds(age)}" for name, age in ages.items()][:-1]
    first, second, third, fourth = (*shown, "", "", "", "")[:4]
    return (first, second), (third, fourth)
