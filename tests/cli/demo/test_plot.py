# SPDX-License-Identifier: Apache-2.0
"""The plot is a well-formed, self-contained SVG file with the curves of the drive."""

from __future__ import annotations

import itertools
import re
from typing import Any
from xml.etree import ElementTree

import pytest

from safety_island.cli.demo.events import KeyEvent
from safety_island.cli.demo.plot import WIDTH, plot, ticks

SVG = "{http://www.w3.org/2000/svg}"


def row(time: float, **values: Any) -> dict[str, Any]:
    silent = 4.0 <= time < 6.0
    return {
        "time": time,
        "x": 10.0 + 5.0 * time,
        "y": 0.2 * time,
        "yaw": 0.04,
        "lateral_error": 0.01 * time,
        "speed": 5.0,
        "target_speed": 5.2,
        "steering": 0.05,
        "steering_command": None if silent else 0.06,
        "island": "SILENT" if silent else "ACTIVE",
        "guard": None if silent else "PASSED",
    } | values


ROWS = [row(0.1 * number) for number in range(100)]
EVENTS = [
    KeyEvent(3.5, "key k: bridge <killed> & gone"),
    KeyEvent(4.0, "island SILENT after 0.50 s, bound 0.73 s", is_reaction=True),
]


def drawn(rows: list[dict[str, Any]], events: list[KeyEvent]) -> ElementTree.Element:
    return ElementTree.fromstring(plot(rows, events, "island demo: s-curve"))


def test_every_curve_is_there_over_the_whole_drive() -> None:
    root = drawn(ROWS, EVENTS)
    lines = [(line.get("class"), line.get("points", "")) for line in root.iter(f"{SVG}polyline")]
    curves = dict(lines)
    assert set(curves) == {
        "planned",
        "driven",
        "error",
        "limit",
        "asked for",
        "commanded",
        "measured",
    }
    assert len(curves["error"].split()) == len(ROWS)
    commanded = [len(points.split()) for name, points in lines if name == "commanded"]
    assert commanded == [40, 40], "there was no command while the island was silent"


def test_axes_have_units_and_numbers() -> None:
    texts = [text.text for text in drawn(ROWS, EVENTS).iter(f"{SVG}text")]
    for label in ("path: y [m]", "x [m]", "lateral error [m]", "speed [m/s]", "time [s]"):
        assert label in texts
    assert "steering angle [rad]" in texts
    assert texts.count("time [s]") == 4
    assert {"2", "4", "8"} <= set(texts)


def test_island_and_guard_are_bars_of_their_states() -> None:
    bars = [title.text for title in drawn(ROWS, EVENTS).iter(f"{SVG}title")][1:]
    assert bars == [
        "ACTIVE from 0.0 s to 4.0 s",
        "SILENT from 4.0 s to 6.0 s",
        "ACTIVE from 6.0 s to 9.9 s",
        "PASSED from 0.0 s to 4.0 s",
        "not asked from 4.0 s to 6.0 s",
        "PASSED from 6.0 s to 9.9 s",
    ]


def test_keys_are_listed_and_marked_in_every_panel_over_time() -> None:
    root = drawn(ROWS, EVENTS)
    texts = [text.text for text in root.iter(f"{SVG}text")]
    assert "1: 3.5 s  key k: bridge <killed> & gone" in texts
    marks = [line for line in root.iter(f"{SVG}line") if line.get("stroke-dasharray") == "2 3"]
    assert len(marks) == 4, "reactions are listed, keys are marked"


def test_everything_lies_in_the_picture_and_nothing_is_loaded() -> None:
    text = plot(ROWS, EVENTS, "title")
    root = ElementTree.fromstring(text)
    assert root.get("width") == str(WIDTH)
    height = float(root.get("height", "0"))
    for line in root.iter(f"{SVG}polyline"):
        for x, y in re.findall(r"([-\d.]+),([-\d.]+)", line.get("points", "")):
            assert 0.0 <= float(x) <= WIDTH
            assert 0.0 <= float(y) <= height
    assert "href" not in text
    assert text.count("http") == 1, "the name space of SVG alone"


def test_path_is_to_scale() -> None:
    """A square path is as high as it is wide."""
    corners = [(0.0, 0.0), (40.0, 0.0), (40.0, 40.0), (0.0, 40.0)]
    rows = [row(float(n), x=x, y=y, lateral_error=0.0) for n, (x, y) in enumerate(corners)]
    (driven,) = [c for c in drawn(rows, []).iter(f"{SVG}polyline") if c.get("class") == "driven"][
        :1
    ]
    points = [tuple(map(float, point.split(","))) for point in driven.get("points", "").split()]
    xs, ys = zip(*points, strict=True)
    assert max(xs) - min(xs) == pytest.approx(max(ys) - min(ys), abs=0.2)


@pytest.mark.parametrize("rows", [[], [row(0.0)]])
def test_a_drive_of_no_length_is_a_picture_too(rows: list[dict[str, Any]]) -> None:
    drawn(rows, [])


@pytest.mark.parametrize(
    ("low", "high", "most"), [(0.0, 1.0, 5), (-0.33, 0.33, 6), (0.0, 123.0, 12), (5.0, 5.001, 4)]
)
def test_ticks_are_round_and_enough(low: float, high: float, most: int) -> None:
    found = ticks(low, high, most)
    assert 2 <= len(found) <= most + 1
    assert all(low - 1e-9 <= value <= high + 1e-9 for value in found)
    steps = [b - a for a, b in itertools.pairwise(found)]
    assert max(steps) == pytest.approx(min(steps), rel=1e-3)
