# SPDX-License-Identifier: Apache-2.0
"""``island bench tick``: the time of one tick of both controllers, in process."""

from __future__ import annotations

import gc
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from time import perf_counter_ns

import numpy as np
import numpy.typing as npt

from safety_island import params
from safety_island.bench import yardstick
from safety_island.bench.node_tick import benchmark_run, node_round
from safety_island.control.follower import TrajectoryFollower
from safety_island.kernel.records import Records
from safety_island.replay.recording import Recording

_WARM_UP_ROUNDS = 2
_YARDSTICKS_A_ROUND = 20
_ODOMETRY = ("x", "y", "z", "qx", "qy", "qz", "qw", "vx", "vy", "wz")


@dataclass(frozen=True)
class TickTimes:
    """Times of a tick [us], and their ratio to the yardstick measured between the rounds.

    ``node_...`` is the whole node around it: bytes, gate, life cycle, guard, status.
    """

    solver: str
    ticks: int
    median_us: float
    p99_us: float
    max_us: float
    yardstick_us: float
    ratio: float
    node_median_us: float
    node_ratio: float

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        return asdict(self)


class _Tick:
    """The benchmark run: a new 220-point trajectory before every tick."""

    def __init__(self, run: Recording, solver: str) -> None:
        changes = run.overrides | {"qp_solver_type": solver}
        self.parameters = params.from_mapping(changes, "firmware")
        self.trajectories: list[Records] = [run.trajectory(k) for k in range(run.ticks)]
        self.stamps = [float(s) for s in run.traj_select[:, 3]]
        columns = [run.state[name] for name in _ODOMETRY]
        self.odometry = [tuple(float(c[k]) for c in columns) for k in range(run.ticks)]
        self.steer, self.ax, self.now = (
            [float(value) for value in run.state[name]] for name in ("steer", "ax", "t")
        )

    def round(self) -> npt.NDArray[np.float64]:
        """Run all ticks with fresh controllers; the time of each [us].

        A tick reaches from decoded inputs to the command: the check of every input, both
        controllers and their hand-over. Copying the points out of the message is decoding.
        """
        follower = TrajectoryFollower(self.parameters)
        follower.offer_operation_mode(2, True)
        times = np.empty(len(self.now))
        for k, now in enumerate(self.now):
            points = self.trajectories[k]
            follower.incoming[: len(points)] = points
            start = perf_counter_ns()
            follower.offer_incoming(len(points), self.stamps[k])
            follower.offer_odometry(*self.odometry[k])
            follower.offer_steering(self.steer[k])
            follower.offer_acceleration(self.ax[k])
            follower.step(now)
            times[k] = (perf_counter_ns() - start) / 1e3
        return times


@contextmanager
def quiet() -> Iterator[None]:
    """Stay on one core, with the garbage collector off."""
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(cores)})
    gc.collect()
    gc.disable()
    try:
        yield
    finally:
        gc.enable()
        os.sched_setaffinity(0, cores)


def measure(
    solver: str = "unconstraint_fast",
    rounds: int = 10,
    report: Callable[[int], None] | None = None,
) -> TickTimes:
    """Measure ``rounds`` rounds of 300 ticks after warm-up; ``report`` is told each round.

    Raises ConfigurationError when osqp, which the yardstick needs, is not installed.
    """
    problem = yardstick.problem()
    run = benchmark_run()
    tick = _Tick(run, solver)
    times: list[npt.NDArray[np.float64]] = []
    node: list[float] = []
    yards: list[float] = []
    with quiet():
        for index in range(_WARM_UP_ROUNDS + rounds):
            measured = tick.round()
            solved = [yardstick.measure_us(problem) for _ in range(_YARDSTICKS_A_ROUND)]
            whole = node_round(solver)
            if index >= _WARM_UP_ROUNDS:
                times.append(measured)
                yards += solved
                node += whole
            if report is not None:
                report(index)
    return _summary(solver, np.concatenate(times), float(np.median(yards)), float(np.median(node)))


def _summary(solver: str, times: npt.NDArray[np.float64], yard: float, node_us: float) -> TickTimes:
    median = float(np.median(times))
    return TickTimes(
        solver=solver,
        ticks=len(times),
        median_us=median,
        p99_us=float(np.percentile(times, 99)),
        max_us=float(times.max()),
        yardstick_us=yard,
        ratio=median / yard,
        node_median_us=node_us,
        node_ratio=node_us / yard,
    )
