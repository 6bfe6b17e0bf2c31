# SPDX-License-Identifier: Apache-2.0
"""Recorded runs of the C++ firmware's controllers, and how a test feeds one to the controllers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from safety_island import params
from safety_island.control.follower import TrajectoryFollower
from safety_island.control.params import Parameters
from safety_island.control.status import Mode
from safety_island.replay.recording import (
    ACCELERATION,
    ODOMETRY,
    OPERATION_MODE,
    STEERING,
    Recording,
    find,
    load,
)

DATA = Path(__file__).parent / "data"
_ODOMETRY_COLUMNS = ("x", "y", "z", "qx", "qy", "qz", "qw", "vx", "vy", "wz")


def run_paths() -> list[Path]:
    """Every recorded run; those of ``bench`` hold the contract's columns only."""
    return find([DATA])


def name_of(path: Path) -> str:
    """``scenario/run``, to name a test."""
    return f"{path.parent.name}/{path.stem}"


def recorded(name: str) -> Recording:
    """Return the run ``scenario/run``."""
    return load(DATA / f"{name}.npz")


def parameters_of(run: Recording) -> params.IslandParameters:
    """Return the parameters that a run was recorded with."""
    return params.from_mapping(run.overrides, "firmware")


def firmware(**values: Any) -> Parameters:
    """Return the firmware's parameters with some fields set by name, whatever their value.

    Raises KeyError for a name that no field has.
    """
    base = params.load_set("firmware")
    groups: list[Any] = []
    for group in (base.vehicle, base.node, base.lateral, base.longitudinal):
        names = {item.name for item in fields(group)}
        chosen = {name: values.pop(name) for name in names & set(values)}
        groups.append(replace(group, **chosen))
    if values:
        raise KeyError(f"no parameter has the name {sorted(values)}")
    return Parameters(*groups)


def played(run: Recording, follower: TrajectoryFollower) -> Iterator[tuple[int, float]]:
    """Offer each tick's messages; yield (tick, now) for the ticks in which a command came out.

    The firmware takes the operation mode as received from the start: STOP, enabled.
    """
    follower.offer_operation_mode(Mode.STOP, True)
    for tick in range(run.ticks):
        if run.has_new_trajectory(tick):
            follower.offer_trajectory(run.trajectory(tick), float(run.traj_select[tick, 3]))
        _offer(run, tick, follower)
        if run.output["published"][tick]:
            yield tick, float(run.state["t"][tick])


def _offer(run: Recording, tick: int, follower: TrajectoryFollower) -> None:
    row = {name: float(column[tick]) for name, column in run.state.items()}
    mask = run.deliver_mask[tick]
    if mask & ODOMETRY:
        follower.offer_odometry(*(row[name] for name in _ODOMETRY_COLUMNS))
    if mask & STEERING:
        follower.offer_steering(row["steer"])
    if mask & ACCELERATION:
        follower.offer_acceleration(row["ax"])
    if mask & OPERATION_MODE:
        follower.offer_operation_mode(int(row["mode"]), bool(row["enabled"]))
