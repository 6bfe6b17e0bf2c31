# SPDX-License-Identifier: Apache-2.0
"""Which release of Autoware the files of a user stand for, and what becomes of keys of others."""

from __future__ import annotations

from pathlib import Path

import pytest

from safety_island.control.release import RELEASES
from safety_island.params import load_set, read
from safety_island.params.no_effect import NO_EFFECT
from safety_island.params.releases import FOREIGN, FORMER, OWN_KEYS, RELEASE, SPANS
from safety_island.params.schema import KNOWN, values_of
from tests.params.files import parameter_file, refused, shipped_text

FILES = (
    "trajectory_follower_node.param.yaml",
    "lateral/mpc.param.yaml",
    "longitudinal/pid.param.yaml",
)


def autowares(release: str, folder: Path) -> list[Path]:
    """Write the files of a shipped set as Autoware has them: without keys of ours and of others."""
    gone = [*OWN_KEYS, *(key for key, span in SPANS.items() if not span.holds(release))]
    leaves = tuple(f"{key.rpartition('.')[2]}:" for key in gone)
    paths = []
    for file in FILES:
        lines = shipped_text(f"autoware-{release}", file).splitlines()
        path = folder / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("\n".join(x for x in lines if not x.strip().startswith(leaves)) + "\n")
        paths.append(path)
    return paths


@pytest.mark.parametrize("release", ["0.40", "0.50", "0.53"])
def test_the_files_of_a_release_are_recognised(tmp_path: Path, release: str) -> None:
    loaded = read(autowares(release, tmp_path))
    assert loaded.parameters.node.autoware_release == release
    assert not loaded.ignored and not loaded.translated
    assert loaded.release.startswith(f"rules of Autoware {release} (by the files: ")


@pytest.mark.parametrize("file", FILES[1:])
@pytest.mark.parametrize(
    ("release", "found"), [("0.40", "0.40"), ("0.50", "0.50"), ("0.53", "0.52")]
)
def test_one_controllers_file_is_enough(
    tmp_path: Path, release: str, found: str, file: str
) -> None:
    """0.53 shows in the node's file only; the others are those of 0.51 and 0.52."""
    paths = {str(p.relative_to(tmp_path)): p for p in autowares(release, tmp_path)}
    assert read([paths[file]]).parameters.node.autoware_release == found


@pytest.mark.parametrize(
    ("lines", "release"),
    [
        ("kp: 1.5", "0.40"),  # of no release: that of the set below stays
        ("slope_source: trajectory_goal_adaptive", "0.50"),
        ("slope_source: raw_pitch", "0.40"),
        ("steering_offset: {max_update_th: 0.01}", "0.52"),
        ("ff_scale_min: 0.6", "0.52"),
        ("cyclic_message_timeout_thr_sec: 0.9", "0.52"),
        ("trajectory_reference_mode: spatial\nff_scale_min: 0.5", "0.53"),
        ("trajectory_reference_mode: spatial\nadmissible_position_error: 5.0", "0.53"),
        ("emergency_state_traj_rot_dev: 0.7854", "0.40"),
        ("admissible_yaw_error_rad: 1.5\nslope_source: trajectory_goal_adaptive", "0.40"),
        ('autoware_release: "0.45"\nff_scale_min: 0.5', "0.45"),
        ("autoware_release: 0.50\nff_scale_min: 0.5", "0.50"),  # without quotes a number
    ],
)
def test_the_release_of_a_part(tmp_path: Path, lines: str, release: str) -> None:
    assert read([parameter_file(tmp_path, lines)]).parameters.node.autoware_release == release


def test_files_are_taken_together(tmp_path: Path) -> None:
    new = parameter_file(tmp_path, "ff_scale_max: 2.0", "pid.param.yaml")
    old = parameter_file(tmp_path, "admissible_position_error: 5.0", "mpc.param.yaml")
    assert read([old, new]).parameters.node.autoware_release == "0.52"


def test_a_set_below_keeps_its_release(tmp_path: Path) -> None:
    path = parameter_file(tmp_path, "kp: 1.5")
    assert read([path], "autoware-0.53").parameters.node.autoware_release == "0.53"


def test_what_decided_is_said(tmp_path: Path) -> None:
    path = parameter_file(tmp_path, "kp: 1.0\nff_scale_min: 0.5")
    expected = (
        f"rules of Autoware 0.52 (by the files: 'ff_scale_min' is there since 0.51, {path}:4)"
    )
    assert read([path]).release == expected


def test_a_release_that_does_not_exist(tmp_path: Path) -> None:
    (told,) = refused([parameter_file(tmp_path, "autoware_release: 0.39")])
    assert "found 0.39 (a number); expected one of 0.40, 0.41" in told


def test_every_key_with_a_span_is_known_or_accepted() -> None:
    assert set(SPANS) <= set(KNOWN) | set(NO_EFFECT)
    assert set(OWN_KEYS) <= set(KNOWN)
    for span in SPANS.values():
        assert {span.first, span.last} - {None} <= set(RELEASES)


def test_no_former_key_is_known() -> None:
    assert not set(FORMER) & (set(KNOWN) | set(NO_EFFECT) | set(FOREIGN))


@pytest.mark.parametrize(
    ("line", "values"),
    [
        ("use_trajectory_for_pitch_calculation: true", {"slope_source": "trajectory_pitch"}),
        ("use_trajectory_for_pitch_calculation: false", {"slope_source": "raw_pitch"}),
        (
            "steer_rate_lim_dps: 35.0",
            {
                "steer_rate_lim_dps_list_by_curvature": (35.0,),
                "curvature_list_for_steer_rate_lim": (0.0,),
                "steer_rate_lim_dps_list_by_velocity": (35.0,),
                "velocity_list_for_steer_rate_lim": (0.0,),
            },
        ),
        (
            "curvature_smoothing_num: 35",
            {"curvature_smoothing_num_traj": 35, "curvature_smoothing_num_ref_steer": 35},
        ),
    ],
)
def test_an_older_key_is_read_as_todays(
    tmp_path: Path, line: str, values: dict[str, object]
) -> None:
    path = parameter_file(tmp_path, line)
    loaded = read([path])
    found = values_of(loaded.parameters)
    assert {key: found[key] for key in values} == values
    (told,) = loaded.translated
    assert told.startswith(f"{path}:3: {line.partition(':')[0]}: is of files before ")


def test_todays_key_wins_over_an_older_one(tmp_path: Path) -> None:
    lines = "slope_source: trajectory_adaptive\nuse_trajectory_for_pitch_calculation: true"
    for text in (lines, "\n".join(reversed(lines.splitlines()))):
        loaded = read([parameter_file(tmp_path, text)])
        assert loaded.parameters.longitudinal.slope_source == "trajectory_adaptive"


def test_a_wrong_value_of_an_older_key_is_refused(tmp_path: Path) -> None:
    lines = refused([parameter_file(tmp_path, "steer_rate_lim_dps: fast")])
    assert "found the text 'fast'" in lines[0]


@pytest.mark.parametrize("key", [key for key, former in FORMER.items() if former.today is None])
def test_what_replaces_an_older_key_is_named(tmp_path: Path, key: str) -> None:
    (told,) = refused([parameter_file(tmp_path, f"{key}: 1.0")])
    assert f"; write {FORMER[key].replaced_by}" in told


@pytest.mark.parametrize("key", FOREIGN)
def test_a_key_of_no_release_is_refused(tmp_path: Path, key: str) -> None:
    (told,) = refused([parameter_file(tmp_path, f"{key}: [1.0, 2.0]")])
    assert "TIER IV" in told and "to no release of Autoware" in told


def test_tables_of_many_speeds_and_negative_overhangs_load(tmp_path: Path) -> None:
    speeds = [1.4 * i for i in range(13)]
    rates = [18.0 - i for i in range(13)]
    body = (
        f"steer_rate_lim_dps_list_by_velocity: {rates}\nvelocity_list_for_steer_rate_lim: {speeds}"
    )
    parameters = read([parameter_file(tmp_path, f"{body}\nrear_overhang: -0.3")]).parameters
    assert parameters.lateral.velocity_list_for_steer_rate_lim == tuple(speeds)
    assert parameters.vehicle.rear_overhang == -0.3


def test_a_long_list_is_shown_cut(tmp_path: Path) -> None:
    rates = [1.5] * 60
    (told,) = refused([parameter_file(tmp_path, f"curvature_list_for_steer_rate_lim: {rates}")])[:1]
    assert " ...] (60 entries); expected a list of 1 to 32 numbers" in told


@pytest.mark.parametrize("name", ["autoware-0.50", "autoware-0.53"])
def test_a_set_of_a_newer_release(name: str) -> None:
    parameters = load_set(name)
    assert parameters.node.autoware_release == name.removeprefix("autoware-")
    assert parameters.longitudinal.slope_source == "trajectory_goal_adaptive"
    assert not parameters.node.enable_deviation_checks
    assert not parameters.longitudinal.enable_overshoot_emergency


def test_the_island_keeps_its_deviation_checks_with_newer_files(tmp_path: Path) -> None:
    """It has no control_validator beside it."""
    assert read(autowares("0.53", tmp_path)).parameters.node.enable_deviation_checks
    assert RELEASE in KNOWN
