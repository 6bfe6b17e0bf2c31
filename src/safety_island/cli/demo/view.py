"""The live view of the demo in a terminal."""

from __future__ import annotations

from rich.console import Group, RenderableType
from rich.panel import Panel
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from safety_island.cli.demo.canvas import CourseMap
from safety_island.cli.demo.events import DemoState
from safety_island.cli.demo.text import (
    can_command,
    can_number,
    command,
    controller,
    milliseconds,
    waiting_for,
)
from safety_island.sim.courses import Course
from safety_island.sim.metrics import MAX_LATERAL_ERROR

COLUMNS, ROWS = 56, 9
"""Size of the map in characters, at most."""
BAR = 34
SCALE = 0.5
"""Lateral error [m] at either end of its scale."""
LOG_LINES = 3


class View:
    """Draws a state; holds nothing but the map of the course."""

    def __init__(self, course: Course, title: str) -> None:
        self._map = CourseMap(course, COLUMNS, ROWS)
        self._title = title

    def draw(self, state: DemoState) -> RenderableType:
        """Return the whole view."""
        parts: list[RenderableType] = [self._course(state), Text(), _figures(state)]
        if state.messages:
            parts += [
                Text(),
                Text("\n".join(state.messages[-LOG_LINES:]), style="dim", no_wrap=True),
            ]
        return Panel(Group(*parts), title=self._title, width=80)

    def _course(self, state: DemoState) -> Text:
        """The map with the vehicle on it."""
        rows, at_row, at_column = self._map.rows(float(state.vehicle.get("station", 0.0)))
        text = Text()
        for number, row in enumerate(rows):
            if number == at_row:
                text.append(row[:at_column], style="cyan")
                text.append("●", style="bold yellow")
                text.append(row[at_column + 1 :] + "\n", style="cyan")
            else:
                text.append(row + "\n", style="cyan")
        return text


def _figures(state: DemoState) -> Table:
    table = Table.grid(padding=(0, 2))
    table.add_column(style="bold", no_wrap=True)
    table.add_column(no_wrap=True)
    table.add_column(no_wrap=True)
    vehicle = state.vehicle
    if not state.is_driving or not vehicle:
        table.add_row("waiting for", waiting_for(state), "")
    if vehicle:
        place, length = float(vehicle["station"]), float(vehicle["length"])
        table.add_row("course", _bar(place, length), f"{place:.0f} of {length:.0f} m")
        speed, target = float(vehicle["speed"]), float(vehicle["target_speed"])
        table.add_row("speed", _bar(speed, max(target, speed)), f"{speed:.2f} of {target:.2f} m/s")
        error = float(vehicle["lateral_error"])
        table.add_row("lateral", _offset(error), f"{error:+.3f} m")
    table.add_row("controller", _bold(controller(state)), command(state))
    if frames := can_command(state):
        table.add_row("CAN frames", Text(frames), can_number(state))
    late = milliseconds(state.tick.get("lateness_s"))
    table.add_row("tick", milliseconds(state.tick.get("tick_s")), f"woken {late} late")
    table.add_row("input ages", _ages(state), "")
    return table


def _bar(value: float, total: float) -> ProgressBar:
    return ProgressBar(total=max(total, 1e-3), completed=max(value, 0.0), width=BAR)


def _offset(error: float) -> Text:
    """The road across, seen in driving direction, with the limits and the vehicle marked."""
    middle = BAR // 2
    cells = ["─"] * (BAR + 1)
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


def _ages(state: DemoState) -> str:
    ages = state.tick.get("ages_s", {})
    shown = [f"{name} {milliseconds(age)}" for name, age in ages.items()][:-1]
    return ", ".join(shown[:2]) + "\n" + ", ".join(shown[2:])
