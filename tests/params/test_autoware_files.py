# SPDX-License-Identifier: Apache-2.0
"""Autoware's own files load unchanged (their keys and values stand in ``data/``)."""

from __future__ import annotations

from pathlib import Path

from safety_island.params import SETS, load_set, read
from safety_island.params.schema import values_of

DATA = Path(__file__).parent / "data"
OURS = {
    "correct_reverse_signs",
    "symmetric_steer_rate_limits",
    "pass_filters_above_nyquist",
}


def ignored_keys(*names: str) -> list[str]:
    return [item.key for item in read([DATA / name for name in names]).ignored]


def test_the_files_of_universe_give_the_set_autoware_040() -> None:
    files = [
        DATA / "universe/lateral/mpc.param.yaml",
        DATA / "universe/longitudinal/pid.param.yaml",
    ]
    values = values_of(read(files, overrides={"ctrl_period": 0.03}).parameters)
    expected = values_of(load_set("autoware-0.40"))
    assert {key for key in values if values[key] != expected[key]} <= OURS


def test_keys_without_effect_are_told() -> None:
    assert ignored_keys("universe/lateral/mpc.param.yaml") == [
        "acceleration_limit",
        "velocity_time_constant",
        "debug_publish_predicted_trajectory",
    ]
    assert ignored_keys("universe/longitudinal/pid.param.yaml") == []
    assert "mass_kg" in ignored_keys("package/lateral_controller_defaults.param.yaml")
    assert ignored_keys("launch/longitudinal/pid.param.yaml") == ["stopped_jerk"]
    assert ignored_keys("launch/vehicle_info.param.yaml") == []


def test_all_files_load_over_every_set_at_their_own_period() -> None:
    node = DATA / "launch/trajectory_follower_node.param.yaml"
    for path in sorted(DATA.rglob("*.yaml")):
        for name in SETS:
            assert read([node, path], name).parameters.node.ctrl_period == 0.03


def test_they_load_over_the_default_set_at_150_ms_too() -> None:
    for path in DATA.rglob("*.param.yaml"):
        assert read([path]).parameters.lateral.vehicle_model_type == "kinematics"


def test_the_files_of_the_launch_package_set_their_values() -> None:
    loaded = read(sorted((DATA / "launch").rglob("*.yaml"))).parameters
    assert loaded.vehicle.wheel_base == 2.79
    assert loaded.lateral.velocity_list_for_steer_rate_lim == (1.0, 3.0)
    assert (loaded.longitudinal.kp, loaded.longitudinal.max_d_effort) == (0.05, 1.0)
    assert loaded.node.timeout_thr_sec == 0.5
