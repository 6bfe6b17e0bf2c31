# SPDX-License-Identifier: Apache-2.0
"""Values that do not fit together."""

from __future__ import annotations

from pathlib import Path

import pytest

from safety_island.params import SETS, check, from_mapping, load_set, notes, with_period
from safety_island.params.consistency import RULES, Rule, inconsistencies
from safety_island.params.schema import KNOWN, values_of
from tests.params.files import parameter_file, refused

BROKEN = [
    ("max_out: 0.5\nmin_out: 0.0\nmax_p_effort: 0.0\nmin_p_effort: 0.0", None),  # the edge is fine
    (
        "smooth_stop_min_strong_acc: -0.4",
        "3: smooth_stop_min_strong_acc: found smooth_stop_min_strong_acc -0.4 above "
        "smooth_stop_max_strong_acc -0.5; expected at most that",
    ),
    (
        "smooth_stop_weak_stop_dist: -0.6",
        "3: smooth_stop_weak_stop_dist: found smooth_stop_strong_stop_dist -0.5 above",
    ),
    ("timeout_thr_sec: 0.1", "3: timeout_thr_sec: found ctrl_period 0.15 above timeout_thr_sec"),
    ("timeout_thr_sec: 0.15", None),
    (
        "curvature_list_for_steer_rate_lim: [0.001, 0.01]",
        "3: curvature_list_for_steer_rate_lim: found 2 entries in curvature_list_for_steer_rate_lim"
        " and 3 in steer_rate_lim_dps_list_by_curvature; expected as many in both",
    ),
    (
        "\nsteer_rate_lim_dps_list_by_velocity: [60, 50, 40, 30]",
        "4: steer_rate_lim_dps_list_by_velocity: found 3 entries",
    ),
    (
        "velocity_list_for_steer_rate_lim: [10, 10, 20]",
        "3: velocity_list_for_steer_rate_lim: found [10.0, 10.0, 20.0]; expected each entry above",
    ),
    ("curvature_list_for_steer_rate_lim: [0.01, 0.002, 0.001]", "expected each entry above"),
    (
        "steering_lpf_cutoff_hz: 10.0",
        "3: steering_lpf_cutoff_hz: found steering_lpf_cutoff_hz 10 Hz at ctrl_period 0.15 s; "
        "expected below its Nyquist frequency of 3.333 Hz, or pass_filters_above_nyquist: true",
    ),
    ("steering_lpf_cutoff_hz: 3.33", None),
    ("steering_lpf_cutoff_hz: 10.0\npass_filters_above_nyquist: true", None),
    ("steering_lpf_cutoff_hz: 10.0\nctrl_period: 0.03", None),
    ("error_deriv_lpf_cutoff_hz: 5.0", None),
    ("error_deriv_lpf_cutoff_hz: 5.0\nvehicle_model_type: dynamics", "found error_deriv_lpf"),
    ("input_delay: 1.92\nctrl_period: 0.03", None),
    (
        "input_delay: 1.95\nctrl_period: 0.03",
        "3: input_delay: found input_delay 1.95 s at ctrl_period 0.03 s; expected at most 64 "
        "periods, 1.92 s",
    ),
    ("delay_compensation_time: 2.0\nctrl_period: 0.005", "found delay_compensation_time 2 s"),
    ("new_traj_duration_time: 10.0\nctrl_period: 0.005", "found new_traj_duration_time 10 s"),
    ("vehicle_model_type: dynamics", None),
    (
        "vehicle_model_type: dynamics\nvehicle: {mass_rl: 0, cf: 0.0}",
        "4: vehicle.mass_rl: found vehicle.mass_rl 0; expected above 0 for vehicle_model_type "
        "dynamics",
    ),
    ("vehicle: {mass_rl: 0, cf: 0.0}", None),
    (
        "stopping_state_stop_dist: 1.6",
        "3: stopping_state_stop_dist: found stopping_state_stop_dist 1.6 m; expected at most "
        "drive_state_stop_dist + drive_state_offset_stop_dist, 1.5 m",
    ),
    (
        "guard.jerk: [5.0, 6.0]",
        "3: guard.jerk: found 5 entries in guard.speed_points and 2 in guard.jerk; expected as"
        " many in both",
    ),
    (
        "guard.speed_points: [0, 1, 1, 2, 3]",
        "3: guard.speed_points: found [0.0, 1.0, 1.0, 2.0, 3.0]; expected each entry above",
    ),
    ("guard: {shortest_step: 0.5}", None),
    (
        "guard: {shortest_step: 0.6}",
        "3: guard.shortest_step: found guard.shortest_step 0.6 above guard.longest_step 0.5",
    ),
    (
        "guard: {longest_step: 0.1}",
        "3: guard.longest_step: found ctrl_period 0.15 above guard.longest_step 0.1",
    ),
]


@pytest.mark.parametrize(("body", "told"), BROKEN, ids=[body[:50] for body, _ in BROKEN])
def test_what_does_not_fit_is_told_at_its_line(tmp_path: Path, body: str, told: str | None) -> None:
    path = parameter_file(tmp_path, body)
    if told is None:
        assert check([path]) == ()
    else:
        first = refused([path])[0]
        assert first.startswith(f"{path}:") and told in first


@pytest.mark.parametrize("rule", RULES, ids=[rule.doc for rule in RULES])
def test_rules_speak_of_known_keys(rule: Rule) -> None:
    assert set(rule.keys) <= set(KNOWN)
    assert all(word in KNOWN for word in rule.doc.split("`")[1::2])


def test_a_rule_waits_for_its_keys() -> None:
    values = values_of(load_set("default"))
    values["timeout_thr_sec"] = 0.01
    assert len(list(inconsistencies(values))) == 1
    del values["timeout_thr_sec"]
    assert not list(inconsistencies(values))


def test_a_filter_that_passes_its_input_is_said_once_at_the_start() -> None:
    firmware = load_set("firmware")
    assert notes(firmware) == [
        "steering_lpf_cutoff_hz 10 Hz is not below the Nyquist frequency of 3.333 Hz:"
        " this filter passes its input through"
    ]
    assert notes(with_period(firmware, 0.03)) == []
    loads = {f"vehicle.{name}": 1.0 for name in ("mass_fl", "mass_fr", "mass_rl", "mass_rr")}
    dynamics = {"vehicle_model_type": "dynamics", "vehicle.cf": 1.0, "vehicle.cr": 1.0, **loads}
    assert len(notes(from_mapping(dynamics, "firmware"))) == 2


@pytest.mark.parametrize("name", SETS)
def test_no_shipped_guard_is_stricter_than_the_shipped_controllers(name: str) -> None:
    assert not [note for note in notes(load_set(name)) if "stricter" in note]


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"max_steer_angle": 0.8}, "guard.steering_angle is 0.75 at most, stricter than max_steer"),
        ({"max_acc": 4.5}, "guard.acceleration is 4 at most, stricter than max_acc, which allows"),
        ({"min_acc": -5.5}, "guard.deceleration is 5 at most, stricter than min_acc, which allows"),
        ({"stopped_acc": -6.0}, "guard.deceleration is 5 at most, stricter than stopped_acc"),
        ({"guard.deceleration": [3.0] * 5, "stopped_acc": -2.0}, "stricter than min_acc"),
        (
            {"steer_rate_lim_dps_list_by_curvature": [90.0, 50.0, 60.0]},
            "stricter than steer_rate_lim_dps_list_by_curvature, which allows 1.5708",
        ),
        (
            {"steer_rate_lim_dps_list_by_velocity": [90.0, 50.0, 60.0]},
            "stricter than steer_rate_lim_dps_list_by_velocity, which allows 1.5708",
        ),
    ],
)
def test_a_guard_stricter_than_the_controllers_is_said_at_the_start(
    changes: dict[str, object], told: str
) -> None:
    (note,) = notes(from_mapping(changes))
    assert told in note and note.endswith("clamps commands that the controllers may give")


def test_both_limits_of_the_change_of_acceleration_are_compared() -> None:
    first, second = notes(from_mapping({"max_acc_cmd_diff": 60.0}))
    assert first.startswith("guard.jerk is 55") and second.startswith("guard.brake_jerk is 55")


@pytest.mark.parametrize("key", ["max_acc", "max_acc_cmd_diff", "max_steer_angle"])
def test_the_firmwares_guard_is_never_stricter(key: str) -> None:
    known = KNOWN[key]
    parameters = from_mapping({key: known.high}, "firmware")
    assert not [note for note in notes(parameters) if "stricter" in note]
