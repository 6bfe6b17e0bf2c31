# SPDX-License-Identifier: Apache-2.0
"""Sets, files over them, values over those; and everything that is wrong at once."""

from __future__ import annotations

from pathlib import Path

import pytest

from safety_island.errors import ConfigurationError
from safety_island.params import (
    ParameterError,
    check,
    describe,
    from_mapping,
    load,
    load_set,
    read,
    replace,
    with_period,
)
from safety_island.params.releases import SPANS
from safety_island.params.schema import KNOWN
from safety_island.params.source import MAX_FILE_BYTES
from tests.params.files import copy_of_set, parameter_file, refused


def test_without_files_it_is_the_default_set() -> None:
    assert load([]) == load_set("default")


def test_a_later_file_wins(tmp_path: Path) -> None:
    first = parameter_file(tmp_path, "kp: 2\nki: 0.2", "first.yaml")
    second = parameter_file(tmp_path, "kp: 3.0\nsteering_offset: {average_num: 5}", "second.yaml")
    loaded = read([first, second])
    assert (loaded.parameters.longitudinal.kp, loaded.parameters.longitudinal.ki) == (3.0, 0.2)
    assert type(loaded.parameters.longitudinal.kp) is float
    assert loaded.parameters.lateral.steering_offset_average_num == 5
    assert str(loaded.origins["kp"]) == f"{second}:3"
    assert str(loaded.origins["ki"]) == f"{first}:4"
    assert str(loaded.origins["kd"]).startswith("default/longitudinal/pid.param.yaml:")


def test_single_values_win_over_files(tmp_path: Path) -> None:
    path = parameter_file(tmp_path, "ctrl_period: 0.1")
    assert load([path], overrides={"ctrl_period": 0.03}).node.ctrl_period == 0.03


def test_a_key_may_stand_in_any_file(tmp_path: Path) -> None:
    path = parameter_file(tmp_path, "wheel_base: 3.0\nkp: 0.5", "lateral/mpc.param.yaml")
    assert load([path]).vehicle.wheel_base == 3.0


def test_all_problems_of_all_files_are_told_one_a_line(tmp_path: Path) -> None:
    first = parameter_file(tmp_path, "kpp: 1\nki: true\nkd: 0.1\nkd: 0.2", "first.yaml")
    second = parameter_file(tmp_path, "input_delay: -1\ntimeout_thr_sec: 0.1", "second.yaml")
    missing = tmp_path / "missing.yaml"
    lines = refused([first, missing, second])
    assert lines == [
        f"{first}:3: kpp: is not a known key; the nearest known key is kp",
        f"{first}:4: ki: found true (a switch); expected a number from 0 to 100 1/s^2",
        f"{first}:6: kd: found a second time, first at {first}:5; expected once",
        f"{missing}: cannot be read: No such file or directory; expected a YAML file of parameters",
        f"{second}:3: input_delay: found -1 (a whole number); expected a number from 0 to 5 s",
        f"{second}:4: timeout_thr_sec: found ctrl_period 0.15 above timeout_thr_sec 0.1; "
        "expected at most that",
    ]
    assert [str(problem) for problem in check([first, missing, second])] == lines


def test_a_key_is_found_twice_whether_nested_or_dotted(tmp_path: Path) -> None:
    body = "steering_offset.average_num: 5\nsteering_offset:\n  average_num: 6"
    (line,) = refused([parameter_file(tmp_path, body)])
    assert ":5: steering_offset.average_num: found a second time, first at" in line


def test_a_refused_value_is_not_mended_by_a_later_file(tmp_path: Path) -> None:
    first = parameter_file(tmp_path, "kp: -1", "first.yaml")
    second = parameter_file(tmp_path, "kp: 1", "second.yaml")
    assert refused([first, second])[0].startswith(f"{first}:3: kp: found -1")


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    (tmp_path / "latin").write_bytes(b"/**:\n  ros__parameters:\n    kp: 1 # \xe4\n")
    (tmp_path / "huge").write_bytes(b"#" * (MAX_FILE_BYTES + 1))
    (tmp_path / "zero").write_bytes(b"")
    told = refused([tmp_path, *(tmp_path / name for name in ("latin", "huge", "zero", "a\0b"))])
    parts = ["Is a directory", "not UTF-8 text", "more than 65536", "found no parameter", "null"]
    assert all(part in line for part, line in zip(parts, told, strict=True))


def test_a_file_without_permission(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def no_permission(path: Path, mode: str) -> None:
        raise PermissionError(13, "Permission denied", str(path))

    path = parameter_file(tmp_path, "kp: 1")
    monkeypatch.setattr(Path, "open", no_permission)
    assert refused([path])[0].startswith(f"{path}: cannot be read: Permission denied; expected")


def test_a_file_may_begin_with_a_byte_order_mark(tmp_path: Path) -> None:
    path = parameter_file(tmp_path, "kp: 2")
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert load([path]).longitudinal.kp == 2.0


def test_without_a_set_the_files_must_be_complete(tmp_path: Path) -> None:
    files = copy_of_set("default", tmp_path)
    assert load(list(files.values()), None) == load_set("default")
    del files["longitudinal/pid.param.yaml"]
    lines = refused(list(files.values()), None)
    expected = [
        key
        for key, known in KNOWN.items()
        if known.group == "longitudinal" and (key not in SPANS or SPANS[key].holds("0.40"))
    ]
    assert [line.split(": ")[1] for line in lines] == expected
    assert lines[0].startswith("no longitudinal/pid.param.yaml: delay_compensation_time: is")


def test_an_unknown_set_is_refused_with_the_list() -> None:
    with pytest.raises(
        ConfigurationError, match=r"firmware, autoware-0.40, .*default; the nearest"
    ):
        load_set("firmwear")
    with pytest.raises(ConfigurationError, match=r"'../default' is not shipped"):
        load_set("../default")


def test_texts_among_single_values_are_read_as_in_a_file() -> None:
    parameters = from_mapping(
        {
            "input_delay": "0.24",
            "use_steer_prediction": "true",
            "vehicle_model_type": "kinematics",
            "curvature_list_for_steer_rate_lim": "[0.0, 0.1, 1]",
            "steering_offset": {"average_num": "100"},
        },
        "firmware",
    )
    assert parameters.lateral.input_delay == 0.24
    assert parameters.lateral.use_steer_prediction is True
    assert parameters.lateral.curvature_list_for_steer_rate_lim == (0.0, 0.1, 1.0)
    assert parameters.lateral.steering_offset_average_num == 100


@pytest.mark.parametrize("text", ["[1, 2", "{a: 1}", "&a 1", "", "0.2 s"])
def test_a_text_that_is_no_value_is_refused(text: str) -> None:
    with pytest.raises(ParameterError, match="override: input_delay: found"):
        from_mapping({"input_delay": text})


def test_another_period_is_checked_again() -> None:
    default = load_set("default")
    assert with_period(default, 0.03).node.ctrl_period == 0.03
    assert with_period(default, 0.15) == default
    with pytest.raises(ParameterError) as caught:
        with_period(load_set("autoware-0.40"), 0.2)
    assert str(caught.value).startswith("--period: ctrl_period: found steering_lpf_cutoff_hz 3 Hz")
    with pytest.raises(ParameterError, match=r"--period: ctrl_period: found nan \(a number\)"):
        with_period(default, float("nan"))


def test_values_may_be_replaced() -> None:
    changed = replace(load_set("firmware"), {"kp": 0.5}, "--set")
    assert changed.longitudinal.kp == 0.5
    with pytest.raises(ParameterError, match="--set: kp: found"):
        replace(changed, {"kp": "high"}, "--set")


def test_rows_for_a_reader(tmp_path: Path) -> None:
    path = parameter_file(tmp_path, "mpc_weight_steer_acc: 1e-5")
    rows = {row.key: row for row in describe(read([path]))}
    assert list(rows) == list(KNOWN)
    row = rows["mpc_weight_steer_acc"]
    assert (row.group, row.kind, row.unit, row.value) == ("lateral", "float", "", "1e-05")
    assert (row.allowed, row.origin) == ("0 to 1e+06", f"{path}:3")
    assert rows["qp_solver_type"].allowed == "unconstraint_fast, osqp, daqp"
    assert rows["enable_smooth_stop"].allowed == "true or false"
