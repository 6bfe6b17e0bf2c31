# SPDX-License-Identifier: Apache-2.0
"""Recorded runs as files: what is read, and what is said of a file that is none."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from safety_island import params
from safety_island.errors import IslandError
from safety_island.replay.feed import Replay
from safety_island.replay.recording import (
    CONTRACT_COLUMNS,
    STATE_COLUMNS,
    RecordingError,
    find,
    load,
)
from tests.golden.harness import DATA
from tests.replay.runs import RUN, TICKS, arrays_of, changed, write


def test_a_run_is_read(tmp_path: Path) -> None:
    run = load(write(tmp_path / "scenario" / "ctrl0.15_x.npz"))
    arrays = arrays_of()
    assert (run.name, run.scenario, run.ticks) == ("scenario/ctrl0.15_x", "scenario", TICKS)
    assert run.solver == "unconstraint_fast"
    assert set(STATE_COLUMNS) <= set(run.state) and set(CONTRACT_COLUMNS) <= set(run.output)
    np.testing.assert_array_equal(run.state["vx"], arrays["state"][:, 8])
    assert run.deliver_mask.tolist() == [15] * TICKS


def test_a_trajectory_is_what_the_message_holds(tmp_path: Path) -> None:
    """Rows of one path, speeds and the rest rounded to float32."""
    arrays = arrays_of()
    arrays["path_points"][:, 7] = 0.1
    arrays["traj_select"][3] = 0, 5, 9, 1000.0
    run = load(write(tmp_path / "a.npz", **arrays))
    points = run.trajectory(3)
    assert len(points) == 4
    np.testing.assert_array_equal(points["x"], arrays["path_points"][5:9, 0])
    assert set(points["v"]) == {np.float32(0.1)}
    assert set(run.path_points[:, 7]) == {float(np.float32(0.1))}


def test_a_trajectory_is_new_when_its_row_changes(tmp_path: Path) -> None:
    select = arrays_of()["traj_select"]
    select[:] = [0, 0, 50, 1000.0]
    select[:2, 0] = -1
    select[5:, 3] = 1001.0
    select[7:, 2] = 60
    run = load(write(tmp_path / "a.npz", traj_select=select))
    new = [tick for tick in range(TICKS) if run.has_new_trajectory(tick)]
    assert new == [2, 5, 7]
    select[:2, 0] = 0
    run = load(write(tmp_path / "b.npz", traj_select=select))
    assert run.has_new_trajectory(0)


def test_parameters_that_are_text_are_read_as_in_a_file(tmp_path: Path) -> None:
    overrides = {"input_delay": "0.24", "enable_path_smoothing": "true", "ctrl_period": 0.15}
    run = load(write(tmp_path / "a.npz", params_json=np.array(json.dumps(overrides))))
    found = params.from_mapping(run.overrides, "firmware").lateral
    assert (found.input_delay, found.enable_path_smoothing) == (0.24, True)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"state": None}, "lacks the array 'state'"),
        ({"params_json": None}, "lacks the array 'params_json'"),
        ({"state": np.zeros(3)}, "state has 1 dimensions, expected 2"),
        ({"state": np.zeros((TICKS, 3))}, "does not fit its names"),
        ({"state": np.zeros((5, 15))}, "state has 5 ticks, deliver_mask 12"),
        ({"state_cols": np.array(list("abcdefghijklmno"))}, "state lacks the column 't'"),
        ({"output": np.zeros((TICKS, 2)), "output_cols": np.array(["t", "x"])}, "'published'"),
        ({"deliver_mask": np.array(["a"] * TICKS)}, "expected numbers"),
        ({"deliver_mask": np.full(TICKS, 1.5)}, "1.5, expected whole numbers"),
        ({"deliver_mask": np.full(TICKS, math.nan)}, "nan, expected whole numbers"),
        ({"deliver_mask": np.zeros((TICKS, 1))}, "has 2 dimensions, expected 1"),
        ({"path_offsets": np.array([0, 10**9])}, "path_offsets ends at 1000000000"),
        ({"path_offsets": np.array([0, 9, 3])}, "does not ascend"),
        ({"path_offsets": np.zeros(0)}, "does not ascend"),
        ({"path_points": np.zeros((600, 5))}, "5 columns, expected 13"),
        ({"path_points": np.zeros((600, 13), complex)}, "complex128, expected numbers"),
        ({"traj_select": np.zeros((TICKS, 3))}, "3 columns, expected 4"),
        (changed("traj_select", 0, 2, 99.0), "names path 99 of 1"),
        (changed("traj_select", 2, 2, 1e6), "reaches beyond its path"),
        (changed("traj_select", 1, 2, -1.0), "reaches beyond its path"),
        (changed("traj_select", 1, 2, math.nan), "nan, expected whole numbers"),
        (changed("traj_select", 3, 2, math.inf), "inf, expected seconds"),
        (changed("state", 0, 4, math.nan), "column 't' holds nan"),
        (changed("state", 0, 4, 1e10), "column 't' holds 1e+10"),
        (changed("state", 0, 4, 999.0), "runs backward"),
        (changed("state", 13, 4, 0.5), "'mode' holds 0.5"),
        (changed("state", 13, 4, 256.0), "'mode' reaches beyond"),
        ({"params_json": np.array("{")}, "params_json: Expecting"),
        ({"params_json": np.array("[1]")}, "params_json is not a map"),
        ({"params_json": np.array("[" * 100_000)}, "params_json: "),
        ({"params_json": np.array('{"a": ' + "9" * 5000 + "}")}, "params_json: Exceeds the limit"),
        ({"state": np.array([1, None], dtype=object)}, "Object arrays cannot be loaded"),
    ],
)
def test_a_file_that_is_no_run(tmp_path: Path, changes: dict[str, Any], words: str) -> None:
    """One line that names the file and what is wrong in it."""
    path = write(tmp_path / "a.npz", **changes)
    with pytest.raises(RecordingError) as told:
        load(path)
    message = str(told.value)
    assert words in message and str(path) in message and "\n" not in message
    assert told.value.exit_code == 2


def test_an_empty_run(tmp_path: Path) -> None:
    path = write(tmp_path / "a.npz", **arrays_of(ticks=0))
    with pytest.raises(RecordingError, match="no ticks"):
        load(path)


@pytest.mark.parametrize("text", [b"", b"no archive", b"PK\x03\x04 cut"])
def test_a_file_that_is_no_archive(tmp_path: Path, text: bytes) -> None:
    path = tmp_path / "a.npz"
    path.write_bytes(text)
    with pytest.raises(RecordingError, match=r"expected a NumPy archive"):
        load(path)


def test_a_path_without_a_file(tmp_path: Path) -> None:
    for wanted in (lambda path: load(path), lambda path: find([path])):
        with pytest.raises(RecordingError, match="does not exist: name a recorded run"):
            wanted(tmp_path / "none.npz")


def test_garbled_archives_never_get_further_than_a_message(tmp_path: Path) -> None:
    """Bytes of a real archive, some of them changed."""
    whole = write(tmp_path / "a.npz").read_bytes()
    rng = np.random.default_rng(2)
    path = tmp_path / "b.npz"
    refused = 0
    for _ in range(150):
        garbled = bytearray(whole)
        for _ in range(int(rng.integers(1, 20))):
            garbled[int(rng.integers(len(garbled)))] = int(rng.integers(256))
        path.write_bytes(garbled[: int(rng.integers(len(garbled) // 2, len(garbled) + 1))])
        try:
            load(path)
        except RecordingError as error:
            refused += 1
            assert "\n" not in str(error)
    assert refused > 100


def test_a_dump_of_one_tick_is_told(tmp_path: Path) -> None:
    path = tmp_path / "run_dump0001.npz"
    np.savez(path, H=np.eye(3), f=np.zeros(3))
    with pytest.raises(RecordingError, match=r"lacks the array 'state' \(it holds H, f, ...\)"):
        load(path)


def test_a_folder_is_searched_without_its_dumps(tmp_path: Path) -> None:
    for name in ("b/two.npz", "a/one.npz", "a/one_dump0003.npz", "a/notes.txt"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    found = [path.relative_to(tmp_path).as_posix() for path in find([tmp_path])]
    assert found == ["a/one.npz", "b/two.npz"]
    named = tmp_path / "a" / "one_dump0003.npz"
    assert find([named, tmp_path / "b"]) == [named, tmp_path / "b" / "two.npz"]


def test_a_folder_without_a_run(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="holds no recorded run"):
        find([tmp_path])


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        ({"ctrl_perid": 0.15}, "nearest known key is ctrl_period"),
        ({"ctrl_period": -1}, "found -1"),
        ({"qp_solver_type": "magic"}, "magic"),
        ({"input_delay": "[1"}, "input_delay"),
        ({"input_delay": {"a": {"b": 1}}}, "input_delay.a.b"),
    ],
)
def test_parameters_that_cannot_be_used_are_told_with_the_file(
    tmp_path: Path, overrides: dict[str, Any], words: str
) -> None:
    run = load(write(tmp_path / "a.npz", params_json=np.array(json.dumps(overrides))))
    with pytest.raises(IslandError) as told:
        Replay(run)
    assert words in str(told.value) and str(tmp_path / "a.npz") in str(told.value)


def test_the_golden_runs_are_found() -> None:
    found = find([DATA])
    assert len(found) == 75
    assert DATA / f"{RUN}.npz" in found
