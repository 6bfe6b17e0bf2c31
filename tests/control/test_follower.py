"""The join of both controllers: readiness, tick, and what no input may do."""

from __future__ import annotations

import math
import tracemalloc
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from safety_island.control.follower import INPUT_NAMES, TrajectoryFollower
from safety_island.control.kernel import JIT
from safety_island.control.limits import MAX_HISTORY, MAX_POINTS
from safety_island.control.records import POINT
from safety_island.control.status import LongitudinalState, MpcStatus, Refusal
from tests.control.hostile import Offer, cases
from tests.control.lateral_rig import PERIOD, START, line, make_points
from tests.golden.harness import firmware, parameters_of, played, recorded

CASES = dict(cases())
STILL = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)


def memory(follower: TrajectoryFollower) -> tuple[Any, ...]:
    """Everything that a refused input must leave as it was, bit for bit."""
    records = (
        *(follower.inputs, follower.points, follower.command, follower.trace),
        *(follower._lateral, follower._longitudinal, follower._work, follower._qp),
    )
    parts = [part for each in records for part in (each if isinstance(each, tuple) else (each,))]
    return (*(part.tobytes() for part in parts), follower.missing(), follower.is_ready())


def driving(**overrides: Any) -> TrajectoryFollower:
    """Five ticks on a straight road, beside it."""
    follower = TrajectoryFollower(firmware(**overrides))
    follower.offer_operation_mode(2, True)
    follower.offer_trajectory(line(80.0, v=4.0), START)
    follower.offer_steering(0.01)
    follower.offer_acceleration(0.1)
    for i in range(5):
        follower.offer_odometry(0.5 * i, 0.2, 0.0, 0.0, 0.0, 0.0, 1.0, 3.0, 0.0, 0.01)
        assert follower.step(START + PERIOD * i)
    return follower


def test_every_input_is_needed() -> None:
    follower = TrajectoryFollower(firmware())
    offers: dict[str, Callable[[], Refusal]] = {
        "trajectory": lambda: follower.offer_trajectory(line(20.0), START),
        "odometry": lambda: follower.offer_odometry(*STILL),
        "steering": lambda: follower.offer_steering(0.0),
        "acceleration": lambda: follower.offer_acceleration(0.0),
        "operation mode": lambda: follower.offer_operation_mode(2, True),
    }
    assert tuple(offers) == INPUT_NAMES
    for i, offer in enumerate(offers.values()):
        assert follower.missing() == INPUT_NAMES[i:]
        assert not follower.is_ready() and not follower.step(START)
        assert follower.command.tobytes() == bytes(follower.command.nbytes)
        assert offer() is Refusal.ACCEPTED
    assert follower.missing() == () and follower.is_ready()
    assert follower.step(START)
    command = follower.command[0]
    assert command.stamp == command.longitudinal_stamp == START


def test_the_operation_mode_is_waited_for() -> None:
    """The firmware takes it as received, STOP, from the start."""
    follower = TrajectoryFollower(firmware())
    follower.offer_trajectory(line(20.0), START)
    follower.offer_odometry(*STILL)
    follower.offer_steering(0.0)
    follower.offer_acceleration(0.0)
    assert follower.missing() == ("operation mode",) and not follower.step(START)


def test_a_path_of_two_points_is_not_enough_until_there_was_a_longer_one() -> None:
    """Then the lateral side keeps the longer one and the longitudinal side takes the new."""
    follower = TrajectoryFollower(firmware())
    follower.offer_odometry(*STILL)
    follower.offer_steering(0.0)
    follower.offer_acceleration(0.0)
    follower.offer_operation_mode(2, True)
    assert follower.offer_trajectory(make_points([0.0, 50.0]), START) is Refusal.ACCEPTED
    assert follower.missing() == () and not follower.is_ready()
    follower.offer_trajectory(line(20.0), START)
    assert follower.step(START)
    assert follower.trace[0].stop_dist == pytest.approx(20.0)
    follower.offer_trajectory(make_points([0.0, 50.0]), START)
    assert follower.step(START + PERIOD)
    assert follower.trace[0].stop_dist == pytest.approx(50.0)
    assert follower._lateral[0].rx[: follower._lateral[0].ref_n].max() < 20.0


def test_each_side_gets_what_the_other_knew_one_tick_ago() -> None:
    follower = driving()
    follower.trace["is_steer_converged"] = True
    follower.run_longitudinal(START + 1.0)
    assert not follower._longitudinal[0].is_steer_converged
    follower.sync()
    assert follower._longitudinal[0].is_steer_converged


def test_statuses_are_named() -> None:
    follower = driving()
    assert follower.run_lateral(START + 1.0) is MpcStatus.SOLVED
    assert LongitudinalState(follower.run_longitudinal(START + 1.0)) in LongitudinalState


def test_the_trajectory_in_force_and_the_one_that_comes_in_are_two() -> None:
    """A decoder may write into ``incoming`` at any time."""
    follower = driving()
    before = memory(follower)
    follower.incoming["x"][:] = math.nan
    assert memory(follower) == before
    assert follower.offer_trajectory(line(9.0), START) is Refusal.ACCEPTED
    assert follower.inputs[0].n_points == 10 and follower.inputs[0].trajectory_id == 2
    np.testing.assert_array_equal(follower.points[:10], line(9.0))


@pytest.fixture(scope="module")
def both() -> tuple[TrajectoryFollower, ...]:
    return driving(), TrajectoryFollower(firmware())


@pytest.mark.parametrize("offer", CASES.values(), ids=list(CASES))
def test_a_refused_input_leaves_everything_as_it_was(
    both: tuple[TrajectoryFollower, ...], offer: Offer
) -> None:
    """Of a follower that drives, and of one that has no input yet."""
    for follower in both:
        before = memory(follower)
        assert offer(follower) is not Refusal.ACCEPTED
        assert memory(follower) == before


@pytest.mark.parametrize(
    ("name", "ticks"),
    [
        ("s_curve/ctrl0.15_unconstraint_fast_alt", 30),
        ("reverse/ctrl0.15_unconstraint_fast_nodelay", 30),
        ("u_turn/ctrl0.15_osqp", 12),
    ],
)
def test_the_next_good_input_gives_what_it_would_have_given(name: str, ticks: int) -> None:
    """A run with every hostile input between any two good ones, beside the run alone."""
    run = recorded(name)
    disturbed, twin = (TrajectoryFollower(parameters_of(run)) for _ in range(2))
    pairs = zip(played(run, disturbed), played(run, twin), strict=True)
    for (tick, now), _ in pairs:
        for offer in CASES.values():
            assert offer(disturbed) is not Refusal.ACCEPTED
        assert disturbed.step(now) and twin.step(now)
        assert memory(disturbed) == memory(twin)
        if tick >= ticks:
            break


def numbers(values: Any) -> Iterator[Any]:
    """Every floating-point column of a record, those of the records inside it included."""
    for name in values.dtype.names or ():
        kind = values.dtype[name].base.kind
        if kind == "f":
            yield values[name]
        elif kind == "V":
            yield from numbers(values[name])


def finite(follower: TrajectoryFollower) -> bool:
    """Whether every number of the command and of both memories is one."""
    records = (follower.command, follower._lateral, follower._longitudinal)
    return all(np.isfinite(column).all() for each in records for column in numbers(each))


def test_random_bytes_do_no_harm() -> None:
    """Whatever a decoder lets through: refused, or followed without a number that is none."""
    rng = np.random.default_rng(11)
    follower = driving()
    accepted = 0
    for i in range(400):
        n = int(rng.choice([2, 3, 10, 60]))
        follower.incoming[:n] = line(59.0)[:n]
        raw = follower.incoming[:n].view(np.uint8)
        for _ in range(int(rng.integers(1, 4))):
            raw[int(rng.integers(len(raw)))] ^= np.uint8(1 << int(rng.integers(8)))
        accepted += follower.offer_incoming(n, START) is Refusal.ACCEPTED
        follower.step(START + 1.0 + i * PERIOD)
        assert finite(follower)
    assert 100 < accepted < 400


@pytest.mark.skipif(not JIT, reason="takes minutes in plain Python")
@pytest.mark.parametrize("solver", ["unconstraint_fast", "daqp"])
def test_nothing_grows_while_the_planner_stands_still(solver: str) -> None:
    """Three thousand ticks on one trajectory, as when the planner has died."""
    follower = driving(qp_solver_type=solver)
    tracemalloc.start()
    try:
        for i in range(3000):
            if i == 500:
                settled = tracemalloc.get_traced_memory()[0]
            follower.offer_odometry(5.0, 0.1, 0.0, 0.0, 0.0, 0.0, 1.0, 0.5, 0.0, 0.0)
            assert follower.step(START + 1.0 + i * PERIOD)
        assert tracemalloc.get_traced_memory()[0] - settled < 1024
    finally:
        tracemalloc.stop()
    lat = follower._lateral[0]
    assert lat.ends_n == 1 and lat.history_n < 12 and lat.predictor_n < 6
    assert follower._longitudinal[0].commands_n <= MAX_HISTORY


def test_points_of_the_wrong_kind_are_a_callers_mistake() -> None:
    """Not an input: the types are fixed, so it is told where it is made."""
    with pytest.raises((TypeError, ValueError)):
        driving().offer_trajectory(np.zeros((3, MAX_POINTS)), START)


def test_a_point_is_laid_out_as_on_the_wire() -> None:
    assert POINT.itemsize == 88
    assert POINT.names[:8] == ("x", "y", "z", "qx", "qy", "qz", "qw", "v")
