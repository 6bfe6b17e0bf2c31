# SPDX-License-Identifier: Apache-2.0
"""A recording through the real node: which messages come when, what comes out."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from safety_island.guard import Limit, Verdict
from safety_island.messages.status import NO_VALUE
from safety_island.replay.compare import judge
from safety_island.replay.feed import Replay, replay
from safety_island.replay.guard_acts import GUARD_COLUMNS, LIMITS, VERDICT
from safety_island.replay.recording import CONTRACT_COLUMNS, load
from tests.golden.harness import recorded
from tests.replay.runs import TICKS, arrays_of, guarded, write


def test_the_columns_are_those_of_the_contract(tmp_path: Path) -> None:
    run = load(write(tmp_path / "a.npz"))
    told: list[int] = []
    columns = replay(run, report=told.append)
    assert set(columns) == {*CONTRACT_COLUMNS, "is_steer_converged", *GUARD_COLUMNS}
    assert all(values.shape == (TICKS,) for values in columns.values())
    np.testing.assert_array_equal(columns["t"], run.state["t"])
    assert told == list(range(TICKS))
    assert judge(run, columns).passed


def test_a_replay_repeats_itself(tmp_path: Path) -> None:
    run = load(write(tmp_path / "a.npz"))
    first, second = replay(run), replay(run)
    for name, values in first.items():
        assert values.tobytes() == second[name].tobytes()


def test_nothing_comes_out_before_everything_came_in(tmp_path: Path) -> None:
    """The operation mode alone counts as received from the start, as in the firmware."""
    arrays = arrays_of()
    arrays["deliver_mask"][:] = [7, 0, 0, 7] + [15] * (TICKS - 4)
    arrays["traj_select"][:3, 0] = -1
    columns = replay(load(write(tmp_path / "a.npz", **arrays)))
    assert columns["published"].tolist() == [0, 0, 0] + [1] * (TICKS - 3)
    assert np.isnan(columns["velocity"][:3]).all() and np.isfinite(columns["velocity"][3:]).all()


@pytest.mark.parametrize("bit", [1, 2, 4])
def test_a_topic_that_is_not_delivered_is_missing(tmp_path: Path, bit: int) -> None:
    mask = np.full(TICKS, 15 - bit)
    assert not replay(load(write(tmp_path / "a.npz", deliver_mask=mask)))["published"].any()


def test_what_is_not_delivered_again_stays(tmp_path: Path) -> None:
    mask = np.array([15] + [0] * (TICKS - 1))
    held = replay(load(write(tmp_path / "a.npz", deliver_mask=mask)))
    arrays = arrays_of()
    arrays["state"][1:, 1:] = arrays["state"][0, 1:]
    repeated = replay(load(write(tmp_path / "b.npz", **arrays)))
    assert held["published"].all()
    for name, values in held.items():
        assert values.tobytes() == repeated[name].tobytes(), name


def test_another_solver_can_be_chosen() -> None:
    run = recorded("s_curve/ctrl0.15_osqp")
    player = Replay(run, "daqp")
    assert player.follower.parameters.lateral.qp_solver_type == "daqp"
    for tick in range(20):
        assert player.tick(tick) is not None
    angle = player.follower.command["steering_tire_angle"][0]
    assert angle == pytest.approx(run.output["steering_tire_angle"][19], abs=1e-5)


def test_an_input_that_is_no_number_is_refused_on_the_way(tmp_path: Path) -> None:
    """The last good one counts, and the run goes on."""
    arrays = arrays_of()
    arrays["state"][4:6, 1] = np.nan
    broken = replay(load(write(tmp_path / "a.npz", **arrays)))
    arrays["state"][4:6, 1:14] = arrays["state"][3, 1:14]
    arrays["state"][4:6, 11:14] = arrays_of()["state"][4:6, 11:14]
    held = replay(load(write(tmp_path / "b.npz", **arrays)))
    assert broken["published"].all()
    for name, values in broken.items():
        assert values.tobytes() == held[name].tobytes(), name


def test_what_is_replayed_is_what_is_published_behind_the_guard(tmp_path: Path) -> None:
    """A guard that is narrower than the recording shows in the columns, the controllers' do not."""
    run = load(write(tmp_path / "a.npz", **guarded(velocity=0.5)))
    columns = replay(run)
    assert (np.abs(run.output["velocity"]) > 0.5).any()
    assert (np.abs(columns["velocity"]) <= 0.5).all()
    changed = columns[VERDICT] == Verdict.CLAMPED
    np.testing.assert_array_equal(changed, columns[LIMITS] == Limit.VELOCITY)
    verdict = judge(run, columns)
    assert not verdict.passed and len(verdict.guard.acts) == changed.sum() > 0


def test_the_bytes_are_those_that_the_node_sent(tmp_path: Path) -> None:
    player = Replay(load(write(tmp_path / "a.npz")))
    for tick in range(TICKS):
        published, sent = player.tick(tick), player.node.sender.command
        assert published is not None and sent is not None
        assert published[:6] == sent.control[:6]


def test_a_tick_without_a_command_has_no_verdict(tmp_path: Path) -> None:
    columns = replay(load(write(tmp_path / "a.npz", deliver_mask=np.full(TICKS, 13))))
    assert (columns[VERDICT] == NO_VALUE).all() and not columns["published"].any()
