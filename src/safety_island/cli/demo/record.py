# SPDX-License-Identifier: Apache-2.0
"""What a drive leaves behind: a CSV file row by row, and the rows for a plot."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Self

from safety_island.cli.demo.events import DemoState
from safety_island.errors import ConfigurationError

Row = Mapping[str, Any]

COLUMNS: Mapping[str, tuple[str, Callable[[DemoState], Any]]] = {
    "time": ("s", lambda state: state.vehicle["time_s"]),
    "lap": ("", lambda state: state.vehicle["lap"]),
    "station": ("m", lambda state: state.vehicle["station"]),
    "x": ("m", lambda state: state.vehicle["x"]),
    "y": ("m", lambda state: state.vehicle["y"]),
    "yaw": ("rad", lambda state: state.vehicle["yaw"]),
    "slope": ("rad", lambda state: state.vehicle["slope"]),
    "lateral_error": ("m", lambda state: state.vehicle["lateral_error"]),
    "speed": ("m/s", lambda state: state.vehicle["speed"]),
    "target_speed": ("m/s", lambda state: state.vehicle["target_speed"]),
    "acceleration": ("m/s^2", lambda state: state.vehicle["acceleration"]),
    "acceleration_command": ("m/s^2", lambda state: state.tick.get("acceleration")),
    "steering": ("rad", lambda state: state.vehicle["steering"]),
    "steering_command": ("rad", lambda state: state.tick.get("steering_tire_angle")),
    "tick": ("s", lambda state: state.tick.get("tick_s")),
    "oldest_input": ("s", lambda state: state.oldest_input_s),
    "vehicle_gate": ("", lambda state: state.vehicle["gate"]),
    "island": ("", lambda state: state.tick.get("state")),
    "reason": ("", lambda state: state.tick.get("reason")),
    "guard": ("", lambda state: state.tick.get("guard")),
    "guard_limits": ("", lambda state: " ".join(state.tick.get("guard_limits", ()))),
}
"""Name -> unit (empty: none) and where the value comes from; ``event`` follows them."""

MOST_ROWS = 20_000
"""Rows that are kept for a plot; beyond that every other one is left out."""


def header() -> list[str]:
    """Return the first line of the CSV file: names with their units."""
    names = [f"{name} [{unit}]" if unit else name for name, (unit, _) in COLUMNS.items()]
    return [*names, "event"]


class Recorder:
    """A context that takes a row at each status of a vehicle that has begun to drive.

    ``log``: the CSV file, None for none. Raises ConfigurationError when it cannot be written.
    """

    def __init__(self, log: Path | None = None, *, keep: bool = False) -> None:
        self.rows: list[Row] = []
        """What a plot is made of; empty unless ``keep``."""
        self._keep, self._known = keep, 0
        self._file = None if log is None else open_output(log)
        self._writer = None if self._file is None else csv.writer(self._file, lineterminator="\n")
        if self._writer is not None:
            self._writer.writerow(header())

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._file is not None:
            self._file.close()

    def __call__(self, state: DemoState) -> None:
        """Take a row."""
        if not state.has_driven:
            return
        row = {name: value_of(state) for name, (_, value_of) in COLUMNS.items()}
        events = "; ".join(event.text for event in state.events[self._known :])
        self._known = len(state.events)
        if self._writer is not None:
            self._writer.writerow([*map(_cell, row.values()), events])
        if self._keep:
            self.rows.append(row)
            if len(self.rows) > MOST_ROWS:
                del self.rows[::2]


def open_output(path: Path) -> Any:
    """Open a text file for writing. Raises ConfigurationError with what is in the way."""
    try:
        return path.open("w", encoding="utf-8", newline="")
    except OSError as error:
        why = str(error.strerror).lower()
        raise ConfigurationError(
            f"cannot write {path}: {why}; name a file in a folder that exists and is yours"
        ) from error


def _cell(value: object) -> object:
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:.6g}" if math.isfinite(value) else ""
    return value
