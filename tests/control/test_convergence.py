# SPDX-License-Identifier: Apache-2.0
"""Memories of the lateral wrapper: commands of a second, ends of trajectories, convergence."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from safety_island.control.convergence import is_mpc_converged, remember_command, remember_end
from safety_island.control.lateral_state import new_lateral_state
from safety_island.control.limits import MAX_HISTORY, MAX_SHAPE_HISTORY
from safety_island.control.records import pack_parameters
from tests.control.lateral_rig import PERIOD, Rig, line, make_points, on_path
from tests.golden.harness import firmware

PARAMS = pack_parameters(firmware())[0]


def state() -> Any:
    return new_lateral_state(firmware())[0]


def history(lat: Any) -> list[tuple[float, float]]:
    return [(float(lat.history_u[i]), float(lat.history_t[i])) for i in range(lat.history_n)]


def pruned(entries: list[tuple[float, float]], now: float) -> list[tuple[float, float]]:
    """The firmware's loop: an index that moves on while the list shrinks from the front."""
    entries, i = list(entries), 0
    while i < len(entries):
        if now - entries[i][1] < 1.0:
            break
        entries.pop(0)
        i += 1
    return entries


@pytest.mark.parametrize("period", [0.15, 0.03, 0.25, 0.125, 1.5])
def test_the_history_is_pruned_as_the_firmware_prunes_it(period: float) -> None:
    lat = state()
    expected: list[tuple[float, float]] = []
    for i in range(120):
        now = 1000.0 + period * i
        remember_command(PARAMS, lat, np.float32(i), now)
        expected.append((float(i), now))
        assert lat.history_filled == (now - expected[0][1] >= 1.0), "told before the pruning"
        expected = pruned(expected, now)
        assert history(lat) == expected


def test_irregular_times_leave_more_than_a_second_for_a_while() -> None:
    """A burst grows old at once, but only every other entry goes each tick."""
    lat = state()
    expected: list[tuple[float, float]] = []
    rng = np.random.default_rng(5)
    now = 1000.0
    for i in range(300):
        now += float(rng.choice([0.001, 0.01, 0.3, 1.2]))
        remember_command(PARAMS, lat, np.float32(i), now)
        expected = pruned([*expected, (float(i), now)], now)
        assert history(lat) == expected


def test_the_history_is_bounded() -> None:
    lat = state()
    for i in range(3 * MAX_HISTORY):
        remember_command(PARAMS, lat, np.float32(i), 1000.0 + 1e-4 * i)
    assert lat.history_n == MAX_HISTORY
    assert history(lat)[-1][0] == 3 * MAX_HISTORY - 1
    assert history(lat)[0][0] == 2 * MAX_HISTORY


@pytest.mark.parametrize(("spread", "converged"), [(0.0, True), (0.0099, True), (0.0101, False)])
def test_commands_have_converged_within_a_hundredth(spread: float, converged: bool) -> None:
    lat = state()
    for i in range(9):
        remember_command(PARAMS, lat, np.float32(spread * (i % 2)), 1000.0 + 0.15 * i)
        assert bool(is_mpc_converged(PARAMS, lat)) == (converged and i >= 7), "1.05 s are known"


def test_a_single_command_says_nothing() -> None:
    lat = state()
    remember_command(PARAMS, lat, np.float32(0.1), 1000.0)
    remember_command(PARAMS, lat, np.float32(0.1), 1010.0)
    assert lat.history_n == 1 and lat.history_filled
    assert not is_mpc_converged(PARAMS, lat)


def ends(lat: Any) -> list[float]:
    return [float(lat.ends_x[i]) for i in range(lat.ends_n)]


def test_ends_are_forgotten_after_a_second_of_stamps() -> None:
    lat = state()
    for i in range(30):
        remember_end(PARAMS, lat, float(i), 0.0, 1000.0 + 0.25 * i)
        assert ends(lat) == [float(j) for j in range(max(0, i - 3), i + 1)]


def test_stamps_that_stand_still_fill_no_memory() -> None:
    lat = state()
    for i in range(2 * MAX_SHAPE_HISTORY):
        remember_end(PARAMS, lat, float(i), 0.0, 1000.0)
    assert lat.ends_n == MAX_SHAPE_HISTORY
    assert ends(lat)[-1] == 2 * MAX_SHAPE_HISTORY - 1


def test_a_stamp_from_the_future_is_forgotten_with_the_next_one() -> None:
    lat = state()
    for stamp in (1000.0, 5000.0, 1000.2, 1000.1):
        remember_end(PARAMS, lat, stamp, 0.0, stamp)
    assert ends(lat) == [1000.1]


def settled(**overrides: Any) -> Rig:
    """Straight ahead for two seconds, the sensor at the command."""
    rig = on_path(line(60.0), **overrides)
    for _ in rig.ticks(14):
        rig.path(line(60.0))
    return rig


def test_steering_converges_after_a_second_of_equal_commands() -> None:
    rig = on_path(line(60.0))
    flags = [bool(trace.is_steer_converged) for trace in rig.ticks(10)]
    assert flags == [False] * 7 + [True] * 3, "the eighth command is 1.05 s younger"
    assert rig.trace.mpc_history_filled


@pytest.mark.parametrize(("measured", "converged"), [(0.08, True), (0.09, False)])
def test_the_sensor_must_show_the_command(measured: float, converged: bool) -> None:
    """Within 0.1 rad; the command answers to the sensor with a fifth of it."""
    rig = settled()
    rig.steer(measured)
    *_, trace = rig.ticks(10)
    apart = abs(rig.angle - measured)
    assert is_mpc_converged(PARAMS, rig.lat)
    assert trace.is_steer_converged == converged == (apart < 0.1)


@pytest.mark.parametrize(("move", "changed"), [(0.299, False), (0.301, True)])
def test_a_trajectory_that_ends_elsewhere_is_a_new_one_for_a_second(
    move: float, changed: bool
) -> None:
    rig = settled()
    flags = []
    for trace in rig.ticks(10):
        flags.append(bool(trace.shape_changed))
        assert trace.is_steer_converged != trace.shape_changed
        rig.path(make_points([*np.arange(60.0), 60.0 + move]))
    # the new end comes with the second tick; one second of stamps is seven periods
    assert flags == [False] + [changed] * 6 + [False] * 3


def test_a_refused_shape_counts_as_the_current_one_but_is_not_remembered() -> None:
    """Two points are no reference, yet their end is compared."""
    rig = settled()
    rig.path(make_points([0.0, 5.0]))
    assert rig.tick().shape_changed
    rig.path(line(60.0))
    assert not rig.tick().shape_changed


def test_a_failed_tick_has_not_converged() -> None:
    rig = settled()
    rig.place(0.0, 6.0)
    assert not rig.tick().is_steer_converged
    rig.place()
    assert rig.tick().is_steer_converged, "what is remembered is still there"
    assert rig.now - rig.lat.history_t[0] == pytest.approx(1.05, abs=PERIOD)
