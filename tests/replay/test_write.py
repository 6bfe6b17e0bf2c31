# SPDX-License-Identifier: Apache-2.0
"""A replay as CSV: names, columns, every digit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from safety_island.errors import IslandError
from safety_island.replay.feed import replay
from safety_island.replay.guard_acts import GUARD_COLUMNS
from safety_island.replay.recording import CONTRACT_COLUMNS, load
from safety_island.replay.write import write_csv
from tests.replay.runs import TICKS, arrays_of, guarded, write

HEADER = (
    "t,published,steering_tire_angle,steering_tire_rotation_rate,velocity,acceleration,"
    "guard_verdict,guard_limits"
)


def test_the_file_holds_what_was_replayed_to_the_last_bit(tmp_path: Path) -> None:
    arrays = arrays_of()
    arrays["traj_select"][:2, 0] = -1
    run = load(write(tmp_path / "bend" / "ctrl0.15_fast.npz", **arrays))
    columns = replay(run)
    path = write_csv(tmp_path, run, columns)
    assert path == tmp_path / "bend__ctrl0.15_fast.csv"
    header, *lines = path.read_text().splitlines()
    assert header == HEADER == ",".join((*CONTRACT_COLUMNS, *GUARD_COLUMNS))
    assert len(lines) == TICKS
    assert lines[0].split(",")[1:] == ["0", "nan", "nan", "nan", "nan", "", ""]
    assert all(line.endswith(",,") for line in lines), "the guard let all pass"
    assert lines[2].split(",")[1] == "1"
    read = np.array([[float(word) for word in line.split(",")[:-2]] for line in lines])
    for i, name in enumerate(CONTRACT_COLUMNS):
        np.testing.assert_array_equal(read[:, i], columns[name], err_msg=name)


def test_what_the_guard_changed_is_named_in_its_row(tmp_path: Path) -> None:
    run = load(write(tmp_path / "a.npz", **guarded(velocity=0.5, steering_angle=[0.001] * 5)))
    columns = replay(run)
    path = write_csv(tmp_path, run, columns)
    rows = [line.split(",") for line in path.read_text().splitlines()[1:]]
    named = [row[6:] for row in rows if row[6:] != ["", ""]]
    assert len(named) == (columns["guard_verdict"] == 1.0).sum() > 0
    assert ["CLAMPED", "ANGLE VELOCITY"] in named
    assert all(abs(float(row[4])) <= 0.5 for row in rows)


def test_a_folder_that_cannot_be_written_is_told(tmp_path: Path) -> None:
    run = load(write(tmp_path / "a.npz"))
    (tmp_path / "file").write_text("")
    columns = {name: np.zeros(TICKS) for name in (*CONTRACT_COLUMNS, *GUARD_COLUMNS)}
    with pytest.raises(IslandError, match=r"file.*cannot be written: "):
        write_csv(tmp_path / "file", run, columns)
