# SPDX-License-Identifier: Apache-2.0
"""A recorded run: what went into the controllers tick by tick, and what came out.

The files are NumPy archives without pickles; their arrays are described in ``docs/recordings.md``.
"""

from __future__ import annotations

import json
import sys
import warnings
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from safety_island.control.records import POINT
from safety_island.errors import IslandError
from safety_island.kernel.cdr import NANOSECONDS
from safety_island.kernel.records import Records
from safety_island.messages.wire import Time
from safety_island.replay import check
from safety_island.replay.check import Table

ODOMETRY, STEERING, ACCELERATION, OPERATION_MODE = 1, 2, 4, 8
"""Bits of ``deliver_mask``."""

STATE_COLUMNS = (
    *("t", "x", "y", "z", "qx", "qy", "qz", "qw"),
    *("vx", "vy", "wz", "ax", "steer", "mode", "enabled"),
)
CONTRACT_COLUMNS = (
    "t",
    "published",
    "steering_tire_angle",
    "steering_tire_rotation_rate",
    "velocity",
    "acceleration",
)
"""The columns of ``output`` that a replay must reproduce."""

_ARRAYS = (
    *("state", "state_cols", "deliver_mask", "path_points", "path_offsets"),
    *("traj_select", "output", "output_cols", "params_json"),
)
MAX_BYTES = 1 << 29
"""What the arrays of a recording may hold together: some hundred times the longest one."""
_OF_NEWER = ("release", "steering_offset_update")
"""Arrays of runs of Autoware's newer releases."""
_RELEASE_OF = {"43": "0.43", "46": "0.46", "48": "0.48", "51": "0.51", "53": "0.53"}


class RecordingError(IslandError):
    """A file that is no recorded run."""

    exit_code = 2


@dataclass(frozen=True)
class Recording:
    """One run; ``state`` and ``output`` are columns by name, each of shape (ticks,)."""

    path: Path
    state: dict[str, Table]
    output: dict[str, Table]
    deliver_mask: npt.NDArray[np.int64]
    traj_select: Table
    path_points: Table
    path_offsets: npt.NDArray[np.int64]
    overrides: dict[str, Any]
    steering_offset: Table | None = None
    """Offset [rad] that came on its topic before each tick, NaN for none; None: never any."""

    @property
    def scenario(self) -> str:
        """Name of the folder that holds the run."""
        return self.path.parent.name

    @property
    def name(self) -> str:
        """``scenario/run``."""
        return f"{self.scenario}/{self.path.stem}"

    @property
    def ticks(self) -> int:
        """Number of ticks."""
        return len(self.deliver_mask)

    @property
    def solver(self) -> str:
        """The solver that the run was recorded with."""
        return str(self.overrides.get("qp_solver_type", "unconstraint_fast"))

    def has_new_trajectory(self, tick: int) -> bool:
        """Whether a trajectory message was delivered before this tick."""
        row = self.traj_select[tick]
        if row[0] < 0:
            return False
        return tick == 0 or bool((row != self.traj_select[tick - 1]).any())

    def trajectory(self, tick: int) -> Records:
        """Points of the trajectory message in force at a tick: POINT records."""
        rows = self._rows(tick)
        points: Records = np.zeros(len(rows), POINT)
        for i, name in enumerate(POINT.names[: check.POINT_COLUMNS]):
            points[name] = rows[:, i]
        times = self._times_ns(rows)
        points["sec"][:-1], points["nanosec"][:-1] = np.divmod(times[1:], NANOSECONDS)
        return points

    def first_time(self, tick: int) -> Time:
        """time_from_start of the first point; each record holds that of the point after it."""
        times = self._times_ns(self._rows(tick))
        return Time.from_nanoseconds(int(times[0])) if len(times) else Time()

    def _rows(self, tick: int) -> Table:
        path, first, end, _ = self.traj_select[tick]
        begin = self.path_offsets[int(path)]
        return self.path_points[begin + int(first) : begin + int(end)]

    @staticmethod
    def _times_ns(rows: Table) -> npt.NDArray[np.int64]:
        if rows.shape[1] <= check.TIME_COLUMN:
            return np.zeros(len(rows), np.int64)
        return np.rint(rows[:, check.TIME_COLUMN] * NANOSECONDS).astype(np.int64)


def load(path: Path) -> Recording:
    """Read a recorded run. Raises RecordingError with what is wrong with the file."""
    _require(path)
    try:
        if not zipfile.is_zipfile(path):
            raise RecordingError(f"{path} is no recorded run: expected a NumPy archive (.npz)")
        _check_size(path)
        arrays = _arrays(path)
    except IslandError:
        raise
    except Exception as error:  # zipfile, zlib and numpy's own parser raise what they like
        why = " ".join(str(error).split()) or type(error).__name__
        raise RecordingError(f"{path} cannot be read as a recorded run: {why}") from None
    return _checked(path, arrays)


def _require(path: Path) -> None:
    """Refuse a path that does not exist, or that cannot be looked at."""
    try:
        exists = path.exists()
    except OSError as error:
        raise RecordingError(f"{path} cannot be read: {error.strerror}") from None
    if not exists:
        raise RecordingError(f"{path} does not exist: name a recorded run (.npz)")


def _check_size(path: Path) -> None:
    """Refuse what would unpack to more than memory should hold; no member becomes larger."""
    with zipfile.ZipFile(path) as archive:
        size = sum(member.file_size for member in archive.infolist())
    if size > MAX_BYTES:
        raise RecordingError(
            f"{path} is no recorded run: its arrays have {size} bytes, expected at most {MAX_BYTES}"
        )


def _arrays(path: Path) -> dict[str, npt.NDArray[Any]]:
    with warnings.catch_warnings(), np.load(path, allow_pickle=False) as data:
        warnings.simplefilter("ignore")  # of numpy, about headers that it mends
        missing = [name for name in _ARRAYS if name not in data.files]
        if missing:
            raise RecordingError(
                f"{path} is no recorded run: it lacks the array '{missing[0]}' "
                f"(it holds {', '.join(data.files[:6])}, ...)"
            )
        found = [name for name in (*_ARRAYS, *_OF_NEWER) if name in data.files]
        return {name: _array(data, name) for name in found}


def _array(data: Any, name: str) -> npt.NDArray[Any]:
    """Return a member; numpy gives bytes for one without the head of an array."""
    array = data[name]
    if not isinstance(array, np.ndarray):
        raise ValueError(f"{name} is no array")
    if array.dtype.kind == "U":  # numpy does not look whether these are characters
        codes = np.frombuffer(array.tobytes(), np.dtype("u4").newbyteorder(array.dtype.byteorder))
        if (codes > sys.maxunicode).any():
            raise ValueError(f"{name} is no text")
    return array


def _checked(path: Path, arrays: dict[str, npt.NDArray[Any]]) -> Recording:
    try:
        recording = Recording(
            path=path.resolve(),
            state=check.columns(arrays["state"], arrays["state_cols"], "state"),
            output=check.columns(arrays["output"], arrays["output_cols"], "output"),
            deliver_mask=check.whole_numbers(arrays["deliver_mask"], "deliver_mask"),
            traj_select=check.numbers(arrays["traj_select"], "traj_select", 2),
            path_points=check.numbers(arrays["path_points"], "path_points", 2),
            path_offsets=check.whole_numbers(arrays["path_offsets"], "path_offsets"),
            overrides=_overrides(str(arrays["params_json"])),
        )
        if "release" in arrays:
            recording = _of_release(recording, arrays)
        _check(recording)
        recording.state["steer"] = check.as_message(recording.state["steer"])
        floats = slice(7, check.POINT_COLUMNS)
        recording.path_points[:, floats] = check.as_message(recording.path_points[:, floats])
    except (ValueError, TypeError, IndexError) as error:
        raise RecordingError(f"{path} is no recorded run: {error}") from None
    return recording


def _of_release(run: Recording, arrays: dict[str, npt.NDArray[Any]]) -> Recording:
    """Return a run of a newer release: its rules, without the checks that it does not have."""
    release = str(arrays["release"])
    if release not in _RELEASE_OF:
        raise ValueError(f"release is {release[:20]!r}, expected one of {', '.join(_RELEASE_OF)}")
    offsets = None
    if "steering_offset_update" in arrays:
        offsets = check.numbers(arrays["steering_offset_update"], "steering_offset_update", 1)
        if len(offsets) != run.ticks:
            raise ValueError(f"steering_offset_update has {len(offsets)} ticks, not {run.ticks}")
        offsets = check.as_message(offsets)
    rules = {"autoware_release": _RELEASE_OF[release], "enable_deviation_checks": False}
    return replace(run, overrides=run.overrides | rules, steering_offset=offsets)


def _overrides(text: str) -> dict[str, Any]:
    """Return the parameters that a run changed; what a text means, params says."""
    try:
        values = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise ValueError(f"params_json: {error}") from None
    if not isinstance(values, dict):
        raise ValueError("params_json is not a map")
    return values


def _check(run: Recording) -> None:
    check.require(run.state, STATE_COLUMNS, "state")
    check.require(run.output, CONTRACT_COLUMNS, "output")
    ticks = {
        "state": len(run.state["t"]),
        "output": len(run.output["t"]),
        "traj_select": len(run.traj_select),
    }
    for name, count in ticks.items():
        if count != run.ticks:
            raise ValueError(f"{name} has {count} ticks, deliver_mask {run.ticks}")
    if run.ticks == 0:
        raise ValueError("it has no ticks")
    check.check_state(run.state)
    check.check_paths(run.path_points, run.path_offsets)
    check.check_selection(run.traj_select, run.path_offsets)


def find(paths: Sequence[Path]) -> list[Path]:
    """Return the recorded runs that files and folders name, sorted within a folder.

    In a folder, dumps of a single tick (``*_dump*.npz``) are passed over. Raises RecordingError
    for a path that does not exist and for a folder without a run.
    """
    found: list[Path] = []
    for path in paths:
        _require(path)
        if not path.is_dir():
            found.append(path)
            continue
        runs = sorted(p for p in path.rglob("*.npz") if "_dump" not in p.stem)
        if not runs:
            raise RecordingError(f"{path} holds no recorded run (*.npz)")
        found += runs
    return found
