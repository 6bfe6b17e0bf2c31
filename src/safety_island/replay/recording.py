"""A recorded run: what went into the controllers tick by tick, and what came out.

The files are NumPy archives without pickles; their arrays are described in ``docs/recordings.md``.
"""

from __future__ import annotations

import json
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import yaml

from safety_island.control.records import POINT, Records
from safety_island.errors import IslandError

Table = npt.NDArray[np.float64]

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
_POINT_COLUMNS = 13


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
        path, first, end, _ = self.traj_select[tick]
        begin = self.path_offsets[int(path)]
        rows = self.path_points[begin + int(first) : begin + int(end)]
        points: Records = np.zeros(len(rows), POINT)
        for i, name in enumerate(POINT.names[:_POINT_COLUMNS]):
            points[name] = rows[:, i]
        return points


def load(path: Path) -> Recording:
    """Read a recorded run. Raises RecordingError with what is wrong with the file."""
    try:
        if path.exists() and not zipfile.is_zipfile(path):
            raise RecordingError(f"{path} is no recorded run: expected a NumPy archive (.npz)")
        with np.load(path, allow_pickle=False) as data:
            missing = [name for name in _ARRAYS if name not in data.files]
            if missing:
                raise RecordingError(
                    f"{path} is no recorded run: it lacks the array '{missing[0]}' "
                    f"(it holds {', '.join(data.files[:6])}, ...)"
                )
            arrays = {name: data[name] for name in _ARRAYS}
    except FileNotFoundError:
        raise RecordingError(f"{path} does not exist: name a recorded run (.npz)") from None
    except (OSError, ValueError, EOFError, zipfile.BadZipFile) as error:
        raise RecordingError(f"{path} cannot be read as a recorded run: {error}") from None
    return _checked(path, arrays)


def _checked(path: Path, arrays: dict[str, npt.NDArray[Any]]) -> Recording:
    try:
        recording = Recording(
            path=path.resolve(),
            state=_columns(arrays["state"], arrays["state_cols"]),
            output=_columns(arrays["output"], arrays["output_cols"]),
            deliver_mask=arrays["deliver_mask"].astype(np.int64),
            traj_select=arrays["traj_select"].astype(np.float64),
            path_points=arrays["path_points"].astype(np.float64),
            path_offsets=arrays["path_offsets"].astype(np.int64),
            overrides=_overrides(str(arrays["params_json"])),
        )
        _check_shapes(recording)
    except (ValueError, TypeError, IndexError, yaml.YAMLError) as error:
        raise RecordingError(f"{path} is no recorded run: {error}") from None
    return recording


def _columns(table: npt.NDArray[Any], names: npt.NDArray[Any]) -> dict[str, Table]:
    if table.ndim != 2 or table.shape[1] != len(names):
        raise ValueError(f"a table of shape {table.shape} does not fit its {len(names)} columns")
    return {str(name): table[:, i].astype(np.float64) for i, name in enumerate(names)}


def _overrides(text: str) -> dict[str, Any]:
    """Return the parameters that a run changed; values that are text are read as YAML scalars."""
    values = json.loads(text)
    if not isinstance(values, dict):
        raise ValueError("params_json is not a map")
    return {k: yaml.safe_load(v) if isinstance(v, str) else v for k, v in values.items()}


def _check_shapes(run: Recording) -> None:
    _require(run.state, STATE_COLUMNS, "state")
    _require(run.output, CONTRACT_COLUMNS, "output")
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
    if run.traj_select.shape[1] != 4 or run.path_points.shape[1] < _POINT_COLUMNS:
        raise ValueError("traj_select needs 4 columns and path_points 13")
    _check_selection(run)


def _check_selection(run: Recording) -> None:
    chosen = run.traj_select[run.traj_select[:, 0] >= 0]
    offsets = run.path_offsets
    if len(offsets) == 0 or (np.diff(offsets) < 0).any() or offsets[-1] > len(run.path_points):
        raise ValueError("path_offsets do not fit path_points")
    if not len(chosen):
        return
    paths = chosen[:, 0].astype(np.int64)
    if paths.max() >= len(offsets) - 1:
        raise ValueError(f"traj_select names path {paths.max()} of {len(offsets) - 1}")
    if (chosen[:, 2] > offsets[paths + 1] - offsets[paths]).any() or (chosen[:, 1] < 0).any():
        raise ValueError("traj_select reaches beyond its path")


def _require(columns: dict[str, Table], names: Sequence[str], what: str) -> None:
    missing = [name for name in names if name not in columns]
    if missing:
        raise ValueError(f"{what} lacks the column '{missing[0]}'")


def find(paths: Sequence[Path]) -> list[Path]:
    """Return the recorded runs that files and folders name, sorted within a folder.

    In a folder, dumps of a single tick (``*_dump*.npz``) are passed over. Raises RecordingError
    for a path that does not exist and for a folder without a run.
    """
    found: list[Path] = []
    for path in paths:
        if not path.is_dir():
            if not path.exists():
                raise RecordingError(f"{path} does not exist: name a recorded run (.npz)")
            found.append(path)
            continue
        runs = sorted(p for p in path.rglob("*.npz") if "_dump" not in p.stem)
        if not runs:
            raise RecordingError(f"{path} holds no recorded run (*.npz)")
        found += runs
    return found
