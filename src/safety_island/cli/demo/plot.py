# SPDX-License-Identifier: Apache-2.0
"""The plot of a drive as one SVG file: path, lateral error, speed, steering angle, guard."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby
from typing import NamedTuple
from xml.sax.saxutils import escape

from safety_island.cli.demo.events import KeyEvent
from safety_island.cli.demo.record import Row
from safety_island.sim.metrics import MAX_LATERAL_ERROR

WIDTH = 1200
LEFT, RIGHT = 90, 30
PATH_HEIGHT, PANEL_HEIGHT, GUARD_HEIGHT, GAP = 300, 170, 90, 62
TOP = 60
GREY, PLAN, DRIVEN, BAD, OTHER = "#8a8f98", "#1f77b4", "#2ca02c", "#d62728", "#ff7f0e"

Points = Sequence[tuple[float, float | None]]
"""A value that is None leaves a gap."""

ISLAND_ROW = {"ACTIVE": DRIVEN, "READY": PLAN, "HOLD": OTHER, "STOP": OTHER, "SILENT": BAD}
GUARD_ROW = {"PASSED": DRIVEN, "CLAMPED": OTHER, "REFUSED": BAD}
"""Colours of the bars; what is not listed is grey."""


class Curve(NamedTuple):
    """A line of a panel: its name in the legend, colour, and points in the panel's units."""

    name: str
    colour: str
    points: Points
    dashes: str = ""


class Frame(NamedTuple):
    """The place of a panel in the picture [px] and what its edges stand for."""

    top: float
    height: float
    x: tuple[float, float]
    y: tuple[float, float]

    def at(self, x: float, y: float) -> tuple[float, float]:
        """Return the place of a point [px]."""
        (x0, x1), (y0, y1) = self.x, self.y
        width = WIDTH - LEFT - RIGHT
        return (
            LEFT + width * (x - x0) / (x1 - x0),
            self.top + self.height * (1.0 - (y - y0) / (y1 - y0)),
        )


def plot(rows: Sequence[Row], events: Sequence[KeyEvent], title: str) -> str:
    """Return the picture of a drive; without rows it says that there was none."""
    if not rows:
        return _document(140, [_text(WIDTH / 2, 80, "nothing was driven", anchor="middle")], title)
    parts: list[str] = []
    top = TOP + 20.0
    parts += _path(rows, top)
    top += PATH_HEIGHT + GAP
    times = (rows[0]["time"], max(rows[-1]["time"], rows[0]["time"] + 1e-3))
    limits = [
        Curve("limit", BAD, [(t, limit) for t in times], "5 4")
        for limit in (MAX_LATERAL_ERROR, -MAX_LATERAL_ERROR)
    ]
    for name, unit, curves in (
        ("lateral error", "m", [_over_time(rows, "lateral_error", "error", DRIVEN), *limits]),
        (
            "speed",
            "m/s",
            [
                _over_time(rows, "target_speed", "asked for", PLAN, "5 4"),
                _over_time(rows, "speed", "driven", DRIVEN),
            ],
        ),
        (
            "steering angle",
            "rad",
            [
                _over_time(rows, "steering_command", "commanded", PLAN, "5 4"),
                _over_time(rows, "steering", "measured", DRIVEN),
            ],
        ),
    ):
        frame = Frame(top, PANEL_HEIGHT, times, _range(curves))
        parts += _panel(frame, f"{name} [{unit}]", "time [s]", curves)
        parts += _event_lines(frame, events, numbered=name == "lateral error")
        top += PANEL_HEIGHT + GAP
    parts += _states(Frame(top, GUARD_HEIGHT, times, (0.0, 2.0)), rows, events)
    top += GUARD_HEIGHT + GAP
    for number, event in enumerate(events, 1):
        parts.append(_text(LEFT, top, f"{number}: {event.time_s:.1f} s  {event.text}"))
        top += 20
    return _document(top + 10, parts, title)


def _path(rows: Sequence[Row], top: float) -> list[str]:
    """The path from above, to scale: planned, as far as it was driven, and driven."""
    planned = [_planned(row) for row in rows]
    driven = [(row["x"], row["y"]) for row in rows]
    width = WIDTH - LEFT - RIGHT
    xs, ys = zip(*planned, *driven, strict=True)
    metres = 1.1 * max((max(xs) - min(xs)) / width, (max(ys) - min(ys)) / PATH_HEIGHT, 0.01)
    x, y = 0.5 * (max(xs) + min(xs)), 0.5 * (max(ys) + min(ys))
    half_x, half_y = 0.5 * metres * width, 0.5 * metres * PATH_HEIGHT
    frame = Frame(top, PATH_HEIGHT, (x - half_x, x + half_x), (y - half_y, y + half_y))
    curves = [Curve("planned", PLAN, planned, "5 4"), Curve("driven", DRIVEN, driven)]
    parts = _panel(frame, "path: y [m]", "x [m]", curves)
    for colour, place in ((GREY, driven[0]), (BAD, driven[-1])):
        cx, cy = frame.at(*place)
        parts.append(f'<circle cx="{cx:.1f}" cy="{cy:.1f}" r="5" fill="{colour}"/>')
    return parts


def _planned(row: Row) -> tuple[float, float]:
    """The point of the path beside the vehicle; its yaw stands for that of the path."""
    error, yaw = row["lateral_error"], row["yaw"]
    return row["x"] + error * math.sin(yaw), row["y"] - error * math.cos(yaw)


def _over_time(rows: Sequence[Row], key: str, name: str, colour: str, dashes: str = "") -> Curve:
    points = [(row["time"], row[key]) for row in rows]
    return Curve(name, colour, points, dashes)


def _range(curves: Sequence[Curve]) -> tuple[float, float]:
    values = [y for curve in curves for _, y in curve.points if y is not None]
    low, high = (min(values), max(values)) if values else (0.0, 1.0)
    margin = 0.08 * (high - low) or 0.5
    return low - margin, high + margin


def _panel(
    frame: Frame,
    y_label: str,
    x_label: str,
    curves: Sequence[Curve],
    *,
    has_numbers: bool = True,
) -> list[str]:
    """Frame, axes with numbers and units, curves and legend."""
    right, bottom = WIDTH - RIGHT, frame.top + frame.height
    parts = []
    for value in ticks(*frame.x, 12):
        x, _ = frame.at(value, 0.0)
        parts.append(_line((x, frame.top), (x, bottom), "#e3e5e8"))
        parts.append(_text(x, bottom + 17, f"{value:g}", anchor="middle"))
    for value in ticks(*frame.y, int(frame.height // 28)) if has_numbers else ():
        _, y = frame.at(0.0, value)
        parts.append(_line((LEFT, y), (right, y), "#e3e5e8"))
        parts.append(_text(LEFT - 8, y + 5, f"{value:g}", anchor="end"))
    parts.append(
        f'<rect x="{LEFT}" y="{frame.top:.1f}" width="{right - LEFT}"'
        f' height="{frame.height:.1f}" fill="none" stroke="{GREY}"/>'
    )
    parts.append(_text(LEFT, frame.top - 9, y_label, weight="bold"))
    parts.append(_text(right, bottom + 34, x_label, anchor="end"))
    for curve in curves:
        parts += _curve(frame, curve)
    return parts + _legend(frame, curves)


def _curve(frame: Frame, curve: Curve) -> list[str]:
    """A line for each stretch without a gap."""
    dashes = f' stroke-dasharray="{curve.dashes}"' if curve.dashes else ""
    parts = []
    for has_value, stretch in groupby(curve.points, lambda point: point[1] is not None):
        if not has_value:
            continue
        places = [frame.at(x, y) for x, y in stretch if y is not None]
        points = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
        parts.append(
            f'<polyline class="{escape(curve.name)}" points="{points}" fill="none"'
            f' stroke="{curve.colour}" stroke-width="2"{dashes}/>'
        )
    return parts


def _legend(frame: Frame, curves: Sequence[Curve]) -> list[str]:
    parts, x = [], WIDTH - RIGHT
    for curve in {curve.name: curve for curve in reversed(curves)}.values():
        x -= 9 * len(curve.name)
        parts.append(_text(x, frame.top - 9, curve.name))
        parts.append(_line((x - 28, frame.top - 14), (x - 6, frame.top - 14), curve.colour, 3))
        x -= 44
    return parts


def _states(frame: Frame, rows: Sequence[Row], events: Sequence[KeyEvent]) -> list[str]:
    """Two bars over time: the state of the island, and what its guard did."""
    parts = _panel(frame, "island and guard", "time [s]", [], has_numbers=False)
    for place, key, colours in ((1.0, "island", ISLAND_ROW), (0.0, "guard", GUARD_ROW)):
        parts.append(_text(LEFT - 8, frame.at(0.0, place + 0.4)[1], key, anchor="end"))
        for start, end, value in _runs(rows, key):
            (x0, y0), (x1, y1) = frame.at(start, place + 0.85), frame.at(end, place + 0.15)
            name = escape(str(value or "not asked"))
            parts.append(
                f'<rect x="{x0:.1f}" y="{y0:.1f}" width="{max(x1 - x0, 1.0):.1f}"'
                f' height="{y1 - y0:.1f}" fill="{colours.get(str(value), GREY)}">'
                f"<title>{name} from {start:.1f} s to {end:.1f} s</title></rect>"
            )
            if x1 - x0 > 9 * len(name):
                parts.append(_text(0.5 * (x0 + x1), 0.5 * (y0 + y1) + 5, name, "middle", "#fff"))
    return parts + _event_lines(frame, events, numbered=False)


def _runs(rows: Sequence[Row], key: str) -> list[tuple[float, float, object]]:
    """Start, end and value of each stretch in which a value stays the same."""
    runs: list[tuple[float, float, object]] = []
    for row in rows:
        if runs and runs[-1][2] == row[key]:
            runs[-1] = (runs[-1][0], row["time"], row[key])
        else:
            if runs:
                runs[-1] = (runs[-1][0], row["time"], runs[-1][2])
            runs.append((row["time"], row["time"], row[key]))
    return runs


def _event_lines(frame: Frame, events: Sequence[KeyEvent], *, numbered: bool) -> list[str]:
    parts = []
    for number, event in enumerate(events, 1):
        x, _ = frame.at(event.time_s, 0.0)
        if event.is_reaction or not LEFT <= x <= WIDTH - RIGHT:
            continue
        parts.append(_line((x, frame.top), (x, frame.top + frame.height), OTHER, dashes="2 3"))
        if numbered:
            parts.append(_text(x + 3, frame.top + 14, str(number), fill=OTHER))
    return parts


def ticks(low: float, high: float, most: int) -> list[float]:
    """Return at most so many round numbers between two."""
    step = 10.0 ** math.floor(math.log10((high - low) / most))
    step *= next(factor for factor in (1.0, 2.0, 5.0, 10.0) if (high - low) / step / factor <= most)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [round(number * step, 10) + 0.0 for number in range(first, last + 1)]


def _line(
    start: tuple[float, float],
    end: tuple[float, float],
    colour: str,
    width: float = 1,
    dashes: str = "",
) -> str:
    dashed = f' stroke-dasharray="{dashes}"' if dashes else ""
    return (
        f'<line x1="{start[0]:.1f}" y1="{start[1]:.1f}" x2="{end[0]:.1f}" y2="{end[1]:.1f}"'
        f' stroke="{colour}" stroke-width="{width}"{dashed}/>'
    )


def _text(
    x: float, y: float, text: str, anchor: str = "start", fill: str = "#222", weight: str = ""
) -> str:
    bold = f' font-weight="{weight}"' if weight else ""
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" fill="{fill}" text-anchor="{anchor}"{bold}>'
        f"{escape(text)}</text>"
    )


def _document(height: float, parts: Sequence[str], title: str) -> str:
    body = "\n".join(parts)
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{height:.0f}"'
        f' viewBox="0 0 {WIDTH} {height:.0f}" font-family="sans-serif" font-size="14">\n'
        f"<title>{escape(title)}</title>\n"
        f'<rect width="{WIDTH}" height="{height:.0f}" fill="#fff"/>\n'
        f'<text x="{WIDTH / 2:.0f}" y="36" font-size="20" text-anchor="middle" fill="#222">'
        f"{escape(title)}</text>\n"
        f"{body}\n</svg>\n"
    )
