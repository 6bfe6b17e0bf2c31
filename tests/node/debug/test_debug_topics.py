# SPDX-License-Identifier: Apache-2.0
"""The debug topics against what Autoware's controllers told in recorded runs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from safety_island.control.follower import TrajectoryFollower
from safety_island.dds import topics
from safety_island.kernel.kernel import JIT
from safety_island.messages.codec import decode
from safety_island.node import ControllerNode
from safety_island.node.debug import DebugTopics, ObservedFollower
from safety_island.node.debug.longitudinal import Number
from safety_island.replay import feed
from safety_island.replay.recording import Recording, load

RUNS = Path(__file__).parents[2] / "golden" / "current"
RECORDED = np.load(Path(__file__).parent / "data" / "columns.npz")
NAMES = sorted({name.rpartition("/")[0] for name in RECORDED.files} - {""})

LATERAL = {
    "u0": 1,
    "uref0": 2,
    "lateral_error": 5,
    "yaw_error": 8,
    "filtered_ref_speed": 9,
    "predicted_steer": 16,
}
LONGITUDINAL = {
    "target_vel": Number.TARGET_VEL,
    "target_acc": Number.TARGET_ACC,
    "nearest_vel": Number.NEAREST_VEL,
    "slope_angle": Number.PITCH_RAD,
    "raw_pitch": Number.PITCH_RAW_RAD,
    "err_vel_filtered": Number.ERROR_VEL_FILTERED,
    "lon_state": Number.CONTROL_STATE,
    "acc_pid_applied": Number.ACC_PID_APPLIED,
    "acc_acc_limited": Number.ACC_ACC_LIMITED,
    "acc_jerk_limited": Number.ACC_JERK_LIMITED,
    "acc_slope_applied": Number.ACC_SLOPE_APPLIED,
    "pid_p": Number.PID_P,
    "pid_i": Number.PID_I,
    "pid_d": Number.PID_D,
    "pred_vel": Number.PREDICTED_VEL,
    "traj_pitch": Number.PITCH_TRAJ_RAD,
    "ff_scale": Number.FF_SCALE,
    "acc_ff": Number.ACC_FF,
    "acc_fb_applied": Number.ACC_FB_APPLIED,
    "pitch_lpf": Number.PITCH_LPF_RAD,
    "smooth_stop_mode": Number.SMOOTH_STOP_MODE,
}

pytestmark = pytest.mark.skipif(not JIT, reason="takes minutes in plain Python")


class Scene:
    """A recorded run played to a node whose debug topics are listened to."""

    def __init__(self, run: Recording, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(feed, "TrajectoryFollower", ObservedFollower)
        self.player = feed.Replay(run)
        self.node = self.player.node
        assert isinstance(self.player.follower, ObservedFollower)
        self.follower = self.player.follower
        self.release = self.node.parameters.node.autoware_release
        self.debug = DebugTopics(self.node)
        self._entries = {entry.key: entry.of_release(self.release) for entry in topics.DEBUG}
        self._listeners = {
            key: self.node.transport.subscription(entry.name, entry.type_name, entry.qos)
            for key, entry in self._entries.items()
        }

    def tick(self, tick: int) -> dict[str, Any]:
        """Return the messages that a tick published, by the key of their topic."""
        self.player.tick(tick)
        return self.observe()

    def observe(self) -> dict[str, Any]:
        """Return the messages about the last tick."""
        assert self.node.report is not None
        self.debug(self.node.report)
        samples = {key: item.take_newest() for key, item in self._listeners.items()}
        return {
            key: decode(self._entries[key].type_name, sample.data)
            for key, sample in samples.items()
            if sample is not None
        }


@pytest.fixture(scope="module")
def played() -> dict[str, dict[int, dict[str, Any]]]:
    """Messages by run and recorded tick."""
    found: dict[str, dict[int, dict[str, Any]]] = {}
    with pytest.MonkeyPatch.context() as monkeypatch:
        for name in NAMES:
            scene, wanted = Scene(load(RUNS / f"{name}.npz"), monkeypatch), ticks_of(name)
            found[name] = {}
            for tick in range(max(wanted) + 1):
                if tick in wanted:
                    found[name][tick] = scene.tick(tick)
                else:
                    scene.player.tick(tick)
                    scene.debug._longitudinal.read()
    return found


def ticks_of(name: str) -> list[int]:
    return [int(tick) for tick in RECORDED[f"{name}/ticks"]]


def recorded(name: str, column: str) -> Any:
    """Return a column of a run, one number for each recorded tick."""
    kind = "exact_columns" if column in RECORDED["exact_columns"] else "columns"
    rows = RECORDED[f"{name}/{'exact' if kind == 'exact_columns' else 'values'}"]
    return rows[:, RECORDED[kind].tolist().index(column)]


def lateral_tolerance(name: str) -> float:
    """OSQP is not exact, and at the limits a solver of our own differs by more."""
    return 2e-6 if name.startswith("u_turn") or "osqp" in name else 1e-7


@pytest.mark.parametrize("name", NAMES)
def test_the_horizon_is_autowares(played: Any, name: str) -> None:
    messages = [played[name][tick]["control_horizon"] for tick in ticks_of(name)]
    second = [message["controls"][1]["lateral"] for message in messages]
    angles = [item["steering_tire_angle"] for item in second]
    rates = [item["steering_tire_rotation_rate"] for item in second]
    assert [len(m["controls"]) for m in messages] == recorded(name, "horizon_n").tolist()
    tolerance = lateral_tolerance(name)
    assert np.allclose(angles, recorded(name, "horizon_u1"), 0.0, tolerance)
    assert np.allclose(rates, recorded(name, "horizon_rate1"), 0.0, 10 * tolerance + 1e-6)


@pytest.mark.parametrize("name", NAMES)
def test_the_predicted_trajectory_is_autowares(played: Any, name: str) -> None:
    paths = [played[name][tick]["predicted_trajectory"]["points"] for tick in ticks_of(name)]
    assert [len(path) for path in paths] == recorded(name, "predicted_traj_n").tolist()
    ends = [path[-1]["pose"]["position"] for path in paths]
    times = [path[-1]["time_from_start"] for path in paths]
    tolerance = 1e3 * lateral_tolerance(name) if name.startswith("u_turn") else 1e-9
    for axis in ("x", "y"):
        expected = recorded(name, f"predicted_last_{axis}")
        assert np.allclose([end[axis] for end in ends], expected, 0.0, tolerance)
    seconds = [time["sec"] + time["nanosec"] * 1e-9 for time in times]
    assert np.allclose(seconds, recorded(name, "predicted_last_t"), 0.0, 1.5e-9)


@pytest.mark.parametrize("name", NAMES)
def test_the_numbers_of_the_mpc_are_autowares(played: Any, name: str) -> None:
    rows = np.array([played[name][tick]["lateral_diagnostic"]["data"] for tick in ticks_of(name)])
    assert rows.shape[1] == (27 if name.endswith(("r53", "launch053_osqp")) else 21)
    for column, place in LATERAL.items():
        tolerance = 2e-4 if name.startswith("u_turn") else 1e-6
        assert np.allclose(rows[:, place], recorded(name, column), 1e-6, tolerance), column


@pytest.mark.parametrize("name", NAMES)
def test_the_numbers_of_the_pid_are_autowares(played: Any, name: str) -> None:
    """Where Autoware's are uninitialised, ours are NaN."""
    data = [played[name][tick]["longitudinal_diagnostic"]["data"] for tick in ticks_of(name)]
    rows = np.array(data)
    assert rows.shape[1] == (43 if name.endswith(("r53", "launch053_osqp")) else 37)
    for column, place in LONGITUDINAL.items():
        ours, known = rows[:, place], ~np.isnan(rows[:, place])
        assert np.allclose(ours[known], recorded(name, column)[known], 1e-6, 1e-5), column
        if column != "smooth_stop_mode":
            assert np.array_equal(known, ~np.isnan(recorded(name, column))), column


def test_the_smooth_stop_shows_its_modes(played: Any) -> None:
    run = played["stop_release/prev_reset_r43"].values()
    modes = [message["longitudinal_diagnostic"]["data"][36] for message in run]
    assert np.isnan(modes[0])
    assert len(set(np.array(modes)[~np.isnan(modes)])) > 1


def test_offset_and_slope_are_told(played: Any) -> None:
    name = "s_curve/offset_r51"
    offsets = [played[name][tick]["estimated_steer_offset"]["data"] for tick in ticks_of(name)]
    expected = recorded(name, "steer_offset_filtered")
    assert np.allclose(offsets, expected, 0.0, 1e-9)
    assert abs(expected).max() > 0.01
    name = "slope_reverse/goal_adaptive_r53"
    slopes = [played[name][tick]["slope_angle"]["data"] for tick in ticks_of(name)]
    assert np.allclose(np.ravel(slopes), recorded(name, "slope_angle"), 0.0, 1e-7)


def test_the_temporal_mode_tells_its_times(played: Any) -> None:
    first, *_, last = (
        message["lateral_diagnostic"]["data"][21:]
        for message in played["s_curve/temporal_r53"].values()
    )
    for row in (first, last):
        assert row[0] == row[2]
        assert row[3] == 0.0
        assert np.isnan(row[[1, 4, 5]]).all()
    spatial = played["slope_reverse/goal_adaptive_r53"].values()
    assert all(np.isnan(m["lateral_diagnostic"]["data"][21:]).all() for m in spatial)
    assert all(np.isnan(m["longitudinal_diagnostic"]["data"][37:]).all() for m in spatial)


def level_of(message: Any, name: str) -> int:
    """Return the level of a diagnostic."""
    levels = {item["name"]: item["level"] for item in message["diagnostics"]["status"]}
    return int(levels[f"controller_node_exe: {name}"])


def test_the_control_state_is_an_error_in_an_emergency_only(played: Any) -> None:
    run = "overshoot/emergency_on_r43"
    levels = [level_of(played[run][tick], "control_state") for tick in ticks_of(run)]
    assert levels == [2 if state == 3 else 0 for state in recorded(run, "lon_state")]
    assert set(levels) == {0, 2}


def test_the_age_of_the_trajectory_is_told_since_051(
    monkeypatch: pytest.MonkeyPatch, played: Any
) -> None:
    old = played["reverse/acc_feedback_r46"].values()
    assert all(len(message["diagnostics"]["status"]) == 2 for message in old)
    scene = Scene(load(RUNS / "s_curve/offset_r51.npz"), monkeypatch)
    assert level_of(scene.observe(), "cyclic_message_timeout") == 2  # none came yet
    assert level_of(scene.tick(0), "cyclic_message_timeout") == 0
    start = scene.node.report
    assert start is not None
    scene.node.tick(start.now + 0.85)
    assert level_of(scene.observe(), "cyclic_message_timeout") == 0
    scene.node.tick(start.now + 0.95)
    assert level_of(scene.observe(), "cyclic_message_timeout") == 2


def test_an_unsolved_tick_has_no_horizon_an_empty_path_and_an_error(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene = Scene(load(RUNS / "s_curve/offset_r51.npz"), monkeypatch)
    scene.tick(0)
    scene.follower.trace["mpc_status"] = 2  # too far
    message = scene.observe()
    assert level_of(message, "MPC_solve_checker") == 2
    assert "control_horizon" not in message
    assert len(message["predicted_trajectory"]["points"]) == 0
    assert len(message["lateral_diagnostic"]["data"]) == 0
    texts = {item["message"] for item in message["diagnostics"]["status"]}
    assert "MPC failed due to getting MPC Data (too large position error)." in texts


def test_every_message_of_a_tick_has_one_stamp(monkeypatch: pytest.MonkeyPatch) -> None:
    messages = Scene(load(RUNS / "s_curve/offset_r51.npz"), monkeypatch).tick(0)
    stamps = [message.get("stamp") or message["header"]["stamp"] for message in messages.values()]
    assert len(stamps) == len(topics.DEBUG)
    assert all(stamp == stamps[0] for stamp in stamps)


def test_a_run_is_the_same_with_debug_topics(monkeypatch: pytest.MonkeyPatch) -> None:
    """The observer writes nothing into the controllers."""
    run = load(RUNS / "s_curve/offset_r51.npz")
    alone = feed.Replay(run)
    observed = Scene(run, monkeypatch)
    for tick in range(60):
        alone.tick(tick)
        observed.tick(tick)
    for record in ("trace", "command", "_lateral", "_longitudinal"):
        ours = getattr(observed.follower, record).tobytes()
        assert ours == getattr(alone.follower, record).tobytes(), record


def test_only_controllers_that_can_be_read_are_observed(monkeypatch: pytest.MonkeyPatch) -> None:
    player = feed.Replay(load(RUNS / "s_curve/offset_r51.npz"))
    assert type(player.follower) is TrajectoryFollower
    with pytest.raises(TypeError, match="expected ObservedFollower"):
        DebugTopics(player.node)


def test_without_them_no_publisher_is_made(monkeypatch: pytest.MonkeyPatch) -> None:
    run = load(RUNS / "s_curve/offset_r51.npz")

    def published(node: ControllerNode) -> int:
        entries = topics.of_release(topics.DEBUG, "0.51")
        return sum(len(node.transport.writers(entry.name, entry.type_name)) for entry in entries)

    assert published(feed.Replay(run).node) == 0
    assert published(Scene(run, monkeypatch).node) == len(topics.DEBUG)


def changed(name: str, **overrides: object) -> Recording:
    """Return a run with other parameters."""
    run = load(RUNS / f"{name}.npz")
    return replace(run, overrides=run.overrides | overrides)


def test_the_arrays_and_diagnostics_of_040(monkeypatch: pytest.MonkeyPatch) -> None:
    run = changed("reverse/acc_feedback_r43", autoware_release="0.40")
    scene = Scene(run, monkeypatch)
    message = scene.tick(0)
    numbers = message["longitudinal_diagnostic"]["data"]
    assert (len(message["lateral_diagnostic"]["data"]), len(numbers)) == (21, 34)
    assert numbers[Number.PITCH_RAD] == np.float32(scene.follower.longitudinal.pitch)
    (state,) = (s for s in message["diagnostics"]["status"] if s["name"].endswith("control_state"))
    assert [item["key"] for item in state["values"]] == [
        "control_state",
        "translation deviation threshold",
        "translation deviation",
        "rotation deviation threshold",
        "rotation deviation",
    ]
    last = message["predicted_trajectory"]["points"][-1]
    assert last["time_from_start"] == {"sec": 0, "nanosec": 0}
    assert last["front_wheel_angle_rad"] == 0.0


def test_a_dynamic_model_is_followed_beside_the_reference(monkeypatch: pytest.MonkeyPatch) -> None:
    """No recording has one: it must begin at the vehicle, and end on the path that it follows."""
    values = {f"vehicle.mass_{wheel}": 600.0 for wheel in ("fl", "fr", "rl", "rr")}
    values |= {"vehicle.cf": 155494.0, "vehicle.cr": 155494.0}
    run = changed("s_curve/offset_disabled_r53", vehicle_model_type="dynamics", **values)
    scene = Scene(run, monkeypatch)
    for tick in range(100):
        message = scene.tick(tick)
    points = message["predicted_trajectory"]["points"]
    inputs, lat = scene.follower.inputs[0], scene.follower.lateral
    places = np.array([[p["pose"]["position"][axis] for axis in ("x", "y")] for p in points])
    reach = abs(inputs.vx) * (lat.delay_n * 0.03 + 2 * lat.prediction_dt)
    assert np.hypot(*(places[0] - (inputs.x, inputs.y))) < reach
    path = np.stack([lat.rx[: lat.ref_n], lat.ry[: lat.ref_n]], axis=1)
    assert np.hypot(*(path - places[-1]).T).min() < 0.2
    assert len(points) > 40


def test_a_solver_tells_its_iterations_and_what_it_minimised(
    monkeypatch: pytest.MonkeyPatch, played: Any
) -> None:
    fast = played["s_curve/offset_r51"].values()
    assert all((m["lateral_diagnostic"]["data"][18:21] == 0.0).all() for m in fast)
    scene = Scene(changed("u_turn/launch053_osqp", qp_solver_type="daqp"), monkeypatch)
    numbers = scene.tick(0)["lateral_diagnostic"]["data"]
    trace, problem = scene.follower.trace[0], scene.follower.problem
    u = trace.u[:50]
    other = 0.5 * (1.01 * u) @ problem.H[:50, :50] @ (1.01 * u) + problem.f[:50] @ (1.01 * u)
    assert numbers[18] == trace.solver_iterations
    assert np.isnan(numbers[19])
    assert numbers[20] < other
    assert numbers[20] == pytest.approx(0.5 * problem.f[:50] @ u, rel=0.5)
