# SPDX-License-Identifier: Apache-2.0
"""The lateral controller on a path of the test's own, for tests that set one thing at a time."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from safety_island.control.follower import TrajectoryFollower
from safety_island.control.records import POINT
from safety_island.control.reference_positions import ensure
from safety_island.control.status import Mode, MpcStatus, Refusal
from safety_island.kernel.records import Records
from tests.golden.harness import firmware

PERIOD = 0.15
START = 1000.0
Values = npt.NDArray[np.float64]


def make_points(x: Any, y: Any = 0.0, v: Any = 1.0, yaw: Any = None) -> Records:
    """Points with positions [m], speeds [m/s] and headings [rad], by default along the path."""
    x, y = np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float))
    points: Records = np.zeros(len(x), POINT)
    if yaw is None:
        yaw = np.arctan2(np.gradient(y), np.gradient(x)) if len(x) > 1 else 0.0
    half = np.asarray(yaw) / 2.0
    columns = {"x": x, "y": y, "v": v, "qz": np.sin(half), "qw": np.cos(half)}
    for name, value in columns.items():
        points[name] = value
    return points


def line(length: float, step: float = 1.0, v: Any = 1.0) -> Records:
    """A straight path along +x from the origin."""
    return make_points(np.arange(0.0, length + 1e-9, step), v=v)


def circle(radius: float, length: float, step: float = 0.5, v: Any = 1.0) -> Records:
    """An arc from the origin, heading along +x; a positive radius turns left."""
    angle = np.arange(0.0, length, step) / radius
    return make_points(radius * np.sin(angle), radius * (1.0 - np.cos(angle)), v, angle)


class Rig:
    """A vehicle at the origin under control; each method changes one thing, ``tick`` runs."""

    def __init__(self, **overrides: Any) -> None:
        self.parameters = firmware(**({"ctrl_period": PERIOD} | overrides))
        self.period = self.parameters.node.ctrl_period
        self.follower = TrajectoryFollower(self.parameters)
        self.now = START - self.period
        self.status = MpcStatus.NO_REFERENCE
        self.mode()
        self.place()
        self.steer(0.0)
        assert self.follower.offer_acceleration(0.0) is Refusal.ACCEPTED

    def mode(self, mode: int = Mode.AUTONOMOUS, enabled: bool = True) -> None:
        """Say who is in control."""
        assert self.follower.offer_operation_mode(mode, enabled) is Refusal.ACCEPTED

    def place(
        self, x: float = 0.0, y: float = 0.0, yaw: float = 0.0, vx: float = 1.0, wz: float = 0.0
    ) -> None:
        """Put the vehicle somewhere with a speed."""
        turn = (0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2))
        assert self.follower.offer_odometry(x, y, 0.0, *turn, vx, 0.0, wz) is Refusal.ACCEPTED

    def steer(self, angle: float) -> None:
        """Set the measured tyre angle [rad]."""
        assert self.follower.offer_steering(angle) is Refusal.ACCEPTED

    def path(self, points: Records, stamp: float | None = None) -> None:
        """Offer a trajectory, stamped now unless told otherwise."""
        stamp = self.now if stamp is None else stamp
        assert self.follower.offer_trajectory(points, stamp) is Refusal.ACCEPTED

    def tick(self, dt: float | None = None) -> Any:
        """Run the lateral controller one period (or ``dt``) later; return the trace."""
        self.now += self.period if dt is None else dt
        self.status = self.follower.run_lateral(self.now)
        return self.trace

    def ticks(self, count: int) -> Iterable[Any]:
        """Run several ticks."""
        for _ in range(count):
            yield self.tick()

    @property
    def trace(self) -> Any:
        """What the last tick did."""
        return self.follower.trace[0]

    @property
    def lat(self) -> Any:
        """The state record of the lateral controller, its reference worked out to the end."""
        lat = self.follower._lateral[0]
        ensure(lat, lat.ref_n)
        return lat

    @property
    def qp(self) -> Any:
        """The quadratic programme of the last tick."""
        return self.follower._qp[0]

    @property
    def angle(self) -> float:
        """The commanded tyre angle [rad]."""
        return float(self.follower.command["steering_tire_angle"][0])

    @property
    def rate(self) -> float:
        """The commanded rate [rad/s]."""
        return float(self.follower.command["steering_tire_rotation_rate"][0])


def on_path(points: Records, **overrides: Any) -> Rig:
    """A rig that was given a path."""
    rig = Rig(**overrides)
    rig.path(points)
    return rig


def stations(rig: Rig) -> Values:
    return np.array(rig.lat.rs[: rig.lat.ref_n])


def column(rig: Rig, name: str) -> Values:
    return np.array(rig.lat[name][: rig.lat.ref_n])


def arc_of(points: Records) -> Values:
    """Plane arc length of received points [m]."""
    steps = np.hypot(np.diff(points["x"]), np.diff(points["y"]))
    return np.concatenate([[0.0], np.cumsum(steps)])
