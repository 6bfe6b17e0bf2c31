"""Recorded runs of the C++ firmware's controllers: how they are read and replayed.

A run holds inputs and outputs tick by tick; ``/work/shared`` is not needed, copies stand in
``data/``. Column names are those of the recordings.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import yaml

from safety_island.control.params import (
    LateralParams,
    LongitudinalParams,
    NodeParams,
    Parameters,
    VehicleParams,
)
from safety_island.control.records import INPUTS, POINT, Records

DATA = Path(__file__).parent / "data"
BASE_YAML = DATA / "params.yaml"

ODOMETRY, STEERING, ACCELERATION, OPERATION_MODE = 1, 2, 4, 8
"""Bits of ``deliver_mask``."""

NOT_RECORDED = {"correct_reverse_signs": False}
"""Parameters of ours that the firmware does not have, with the value that is its behaviour."""


@dataclass(frozen=True)
class Run:
    """One recording; ``state`` and ``output`` are columns by name, each of shape (ticks,)."""

    name: str
    ticks: int
    state: dict[str, npt.NDArray[np.float64]]
    output: dict[str, npt.NDArray[np.float64]]
    deliver_mask: npt.NDArray[np.int64]
    traj_select: npt.NDArray[np.float64]
    path_points: npt.NDArray[np.float64]
    path_offsets: npt.NDArray[np.int64]
    overrides: dict[str, Any]


def columns(table: npt.NDArray[np.float64], names: Any) -> dict[str, npt.NDArray[np.float64]]:
    """Return the columns of a (ticks, n) table by name."""
    return {str(name): table[:, i] for i, name in enumerate(names)}


def load_run(path: Path) -> Run:
    """Read one ``.npz``; override values that are text are read as YAML scalars."""
    with np.load(path) as data:
        texts = json.loads(str(data["params_json"]))
        return Run(
            name=f"{path.parent.name}/{path.stem}",
            ticks=len(data["state"]),
            state=columns(data["state"], data["state_cols"]),
            output=columns(data["output"], data["output_cols"]),
            deliver_mask=data["deliver_mask"].astype(np.int64),
            traj_select=data["traj_select"],
            path_points=data["path_points"],
            path_offsets=data["path_offsets"].astype(np.int64),
            overrides={k: yaml.safe_load(v) if isinstance(v, str) else v for k, v in texts.items()},
        )


def run_paths(pattern: str = "*/*.npz") -> list[Path]:
    """Every recorded run, without the benchmark runs."""
    return sorted(path for path in DATA.glob(pattern) if path.parent.name != "bench")


def bench_paths() -> list[Path]:
    """The benchmark runs; they hold the first six output columns only."""
    return sorted(DATA.glob("bench/*.npz"))


def parameters_of(run: Run, base_yaml: Path = BASE_YAML) -> Parameters:
    """Return the parameters that a run was recorded with; what it does not declare is 0."""
    values = yaml.safe_load(base_yaml.read_text()) | run.overrides
    return parameters_from({key.replace(".", "_"): value for key, value in values.items()})


def parameters_from(values: dict[str, Any]) -> Parameters:
    """Fill the parameter dataclasses by field name."""
    groups: list[Any] = [
        group(**{item.name: _value(item.name, str(item.type), values) for item in fields(group)})
        for group in (VehicleParams, NodeParams, LateralParams, LongitudinalParams)
    ]
    return Parameters(*groups)


def _value(name: str, kind: str, values: dict[str, Any]) -> Any:
    value = values.get(name, NOT_RECORDED.get(name, 0))
    if kind.startswith("tuple"):
        return tuple(float(item) for item in value)
    return {"float": float, "int": int, "bool": bool, "str": str}[kind](value)


def trajectory(run: Run, tick: int) -> Records:
    """Points of the trajectory message in force at a tick, shape (points,), POINT."""
    path, first, end, _ = run.traj_select[tick]
    begin = run.path_offsets[int(path)]
    rows = run.path_points[begin + int(first) : begin + int(end)]
    points: Records = np.zeros(len(rows), POINT)
    for i, name in enumerate(POINT.names[:13]):
        points[name] = rows[:, i]
    return points


def new_trajectory(run: Run, tick: int) -> bool:
    """Whether a trajectory message was delivered before this tick."""
    if run.traj_select[tick, 0] < 0:
        return False
    return tick == 0 or bool((run.traj_select[tick] != run.traj_select[tick - 1]).any())


def deliver(run: Run, tick: int, inputs: Records) -> None:
    """Write the messages of a tick into the inputs; what was not delivered stays as it was."""
    mask = run.deliver_mask[tick]
    delivered = {
        ODOMETRY: "x y z qx qy qz qw vx vy wz",
        STEERING: "steer",
        ACCELERATION: "ax",
        OPERATION_MODE: "mode enabled",
    }
    for bit, names in delivered.items():
        if mask & bit:
            for name in names.split():
                inputs[0][name] = run.state[name][tick]


def first_inputs() -> Records:
    """Inputs before the first tick: the firmware takes the mode as received, STOP and enabled."""
    inputs: Records = np.zeros(1, INPUTS)
    inputs[0].qw = 1.0
    inputs[0].mode = 1
    inputs[0].enabled = True
    return inputs


def replayed_ticks(run: Run, inputs: Records, points: Records) -> Iterator[tuple[int, float]]:
    """Deliver each tick's messages and yield (tick, now) for the ticks that gave a command.

    A trajectory of fewer than two points or with a value that is not finite is refused: the
    longitudinal controller keeps the one before.
    """
    for tick in range(run.ticks):
        if new_trajectory(run, tick):
            message = trajectory(run, tick)
            inputs[0].trajectory_stamp = run.traj_select[tick, 3]
            if is_acceptable(message):
                points[: len(message)] = message
                inputs[0].n_points = len(message)
                inputs[0].trajectory_id += 1
        deliver(run, tick, inputs)
        if run.output["published"][tick]:
            yield tick, float(run.state["t"][tick])


def is_acceptable(message: Records) -> bool:
    """Two points or more, and every value finite that the longitudinal controller checks."""
    checked = ("x", "y", "z", "qx", "qy", "qz", "qw", "v", "v_lat", "acc", "heading_rate")
    return len(message) >= 2 and all(bool(np.isfinite(message[name]).all()) for name in checked)
