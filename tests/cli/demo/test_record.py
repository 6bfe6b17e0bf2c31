# SPDX-License-Identifier: Apache-2.0
"""The CSV file of a drive: columns with units, a row at each status, events beside them."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from safety_island.cli.demo.events import ISLAND, VEHICLE, DemoState
from safety_island.cli.demo.record import Recorder, header
from safety_island.errors import ConfigurationError
from tests.cli.demo.samples import STATUS, TICK


def test_columns_name_their_units() -> None:
    names = header()
    for name in (
        "time [s]",
        "station [m]",
        "x [m]",
        "y [m]",
        "yaw [rad]",
        "lateral_error [m]",
        "speed [m/s]",
        "target_speed [m/s]",
        "steering [rad]",
        "steering_command [rad]",
        "acceleration [m/s^2]",
        "guard",
        "event",
    ):
        assert name in names
    assert len(set(names)) == len(names)


def test_a_row_at_each_status_of_a_vehicle_that_drives(tmp_path: Path) -> None:
    state = DemoState()
    with Recorder(tmp_path / "drive.csv") as recorder:
        state.on_status.append(recorder)
        state.update(ISLAND, TICK)
        state.update(VEHICLE, STATUS | {"gate": "ready"})
        state.update(VEHICLE, STATUS)
        state.add_event("key k: bridge killed")
        state.update(VEHICLE, STATUS | {"time_s": 12.4, "gate": "braking", "speed": 7.5})
        state.update(ISLAND, {"event": "tick", "state": "SILENT"})
        state.update(VEHICLE, STATUS | {"time_s": 12.5})
    assert recorder.rows == [], "nothing is kept when no plot is wanted"
    first, second, third = csv.DictReader((tmp_path / "drive.csv").read_text().splitlines())
    assert first["time [s]"] == "12.3"
    assert first["steering_command [rad]"] == "0.1"
    assert (first["island"], first["guard"], first["event"]) == ("ACTIVE", "PASSED", "")
    assert (second["vehicle_gate"], second["speed [m/s]"]) == ("braking", "7.5")
    assert second["event"] == "key k: bridge killed"
    assert (third["island"], third["steering_command [rad]"], third["event"]) == ("SILENT", "", "")


def test_rows_are_kept_for_a_plot_and_thinned_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("safety_island.cli.demo.record.MOST_ROWS", 10)
    state, recorder = DemoState(), Recorder(keep=True)
    state.on_status.append(recorder)
    for number in range(40):
        state.update(VEHICLE, STATUS | {"time_s": float(number)})
    times = [row["time"] for row in recorder.rows]
    assert 5 <= len(times) <= 10
    assert times == sorted(times)
    assert times[-1] == 39.0


def test_a_file_that_cannot_be_written_is_told(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match=r"cannot write .*no such file or directory; name"):
        Recorder(tmp_path / "missing" / "drive.csv")
