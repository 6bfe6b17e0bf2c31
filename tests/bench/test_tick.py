# SPDX-License-Identifier: Apache-2.0
"""The tick bench: what it measures, and that it leaves the process as it was."""

from __future__ import annotations

import gc
import os

import numpy as np
import pytest

from safety_island.bench import tick, yardstick
from safety_island.bench.node_tick import RUN, benchmark_run
from safety_island.bench.tick import TickTimes, measure, quiet
from safety_island.control.follower import TrajectoryFollower
from safety_island.replay.recording import load
from tests.golden.harness import DATA

pytest.importorskip("osqp")


def test_the_run_is_the_benchmark_run() -> None:
    """A new trajectory of 220 points before every tick, 300 ticks, horizon 50."""
    run, golden = benchmark_run(), load(DATA / "bench" / RUN)
    assert run.ticks == 300
    assert all(run.has_new_trajectory(k) for k in range(run.ticks))
    assert {len(run.trajectory(k)) for k in range(run.ticks)} == {220}
    for name, column in golden.state.items():
        np.testing.assert_array_equal(run.state[name], column)
    np.testing.assert_array_equal(run.path_points, golden.path_points)


@pytest.mark.parametrize("solver", ["unconstraint_fast", "daqp"])
def test_every_measured_tick_is_a_whole_one(solver: str) -> None:
    """All inputs taken, a command each time: else the time would say little."""
    bench = tick._Tick(benchmark_run(), solver)
    assert bench.parameters.lateral.qp_solver_type == solver
    assert bench.parameters.lateral.mpc_prediction_horizon == 50
    follower = TrajectoryFollower(bench.parameters)
    follower.offer_operation_mode(2, True)
    for k, now in enumerate(bench.now):
        assert not follower.offer_trajectory(bench.trajectories[k], bench.stamps[k])
        assert not follower.offer_odometry(*bench.odometry[k])
        assert not follower.offer_steering(bench.steer[k])
        assert not follower.offer_acceleration(bench.ax[k])
        assert follower.step(now) and follower.trace[0].mpc_status == 0
        assert follower.trace[0].under_control


def test_a_measurement() -> None:
    told: list[int] = []
    times = measure("daqp", 1, told.append)
    assert isinstance(times, TickTimes)
    assert (times.solver, times.ticks, told) == ("daqp", 300, [0, 1, 2])
    assert 0.0 < times.median_us <= times.p99_us <= times.max_us
    assert times.node_median_us > times.median_us
    assert times.ratio == times.median_us / times.yardstick_us
    assert set(times.as_dict()) >= {"median_us", "p99_us", "max_us", "yardstick_us", "ratio"}


def test_the_process_is_left_as_it_was() -> None:
    cores = os.sched_getaffinity(0)
    with pytest.raises(RuntimeError), quiet():
        assert len(os.sched_getaffinity(0)) == 1 and not gc.isenabled()
        raise RuntimeError
    assert os.sched_getaffinity(0) == cores and gc.isenabled()


def test_the_yardstick_is_one_cold_polished_solve() -> None:
    """OSQP finds and polishes the optimum of the problem, the same every time."""
    problem = yardstick.problem()
    first, second = problem.solve(), problem.solve()
    assert problem.hessian.shape == (50, 50) and problem.rows.shape == (100, 50)
    assert first.info.status == "solved"
    assert first.x.tobytes() == second.x.tobytes()
    dense = problem.hessian.toarray()
    dense = dense + np.triu(dense, 1).T
    np.testing.assert_allclose(first.x, -np.linalg.solve(dense, problem.gradient), atol=1e-2)
    assert yardstick.measure_us(problem) > 0.0
