# SPDX-License-Identifier: Apache-2.0
"""The shipped sets hold what they say."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import yaml

from safety_island.params import SETS, from_mapping, load_set, read, with_period
from safety_island.params.no_effect import NO_EFFECT
from safety_island.params.reasons import REASONS
from safety_island.params.releases import SPANS
from safety_island.params.schema import KNOWN, values_of
from safety_island.params.sets import EXCEPTIONS, FILES, OWN
from tests.params.files import OWN_KEYS, shipped_text

GOLDEN = Path(__file__).parents[1] / "golden" / "data"
OURS = {"correct_reverse_signs", "symmetric_steer_rate_limits", "pass_filters_above_nyquist"}
NEWER = {key for key, span in SPANS.items() if key in KNOWN and not span.holds("0.40")} | {
    "autoware_release",
    "enable_deviation_checks",
    "steering_offset.input_limit",
}
"""Keys that neither the firmware nor Autoware 0.40 has."""


def recorded() -> dict[str, object]:
    """The firmware's parameters as its runs list them; a number without a point is a text here."""
    values = yaml.safe_load((GOLDEN / "params.yaml").read_text("utf-8"))
    return {key: float(v) if key.endswith("steer_acc") else v for key, v in values.items()}


def test_the_firmware_set_is_what_was_recorded() -> None:
    values, golden = values_of(load_set("firmware")), recorded()
    for key, value in golden.items():
        if key not in NO_EFFECT:
            assert values[key] == (tuple(value) if isinstance(value, list) else value), key
    undeclared = {key for key in KNOWN if key.startswith("vehicle.")}
    assert set(values) - set(golden) == undeclared | OURS | OWN_KEYS | NEWER
    assert all(values[key] == 0.0 for key in undeclared)


def test_the_firmware_set_keeps_what_is_the_firmwares() -> None:
    values = values_of(load_set("firmware"))
    assert [values[key] for key in sorted(OURS)] == [False, True, False]


def run_paths() -> list[Path]:
    return sorted(GOLDEN.glob("*/*.npz"))


@pytest.mark.parametrize("path", run_paths(), ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_the_values_of_every_recorded_run_are_allowed(path: Path) -> None:
    with np.load(path) as data:
        overrides = json.loads(str(data["params_json"]))
    values = values_of(from_mapping(overrides, "firmware"))
    for key, text in overrides.items():
        expected = text if KNOWN[key].kind == "str" else yaml.safe_load(str(text))
        assert values[key] == expected


def test_the_autoware_set_is_the_recorded_variant_of_it() -> None:
    with np.load(GOLDEN / "s_curve" / "ctrl0.03_osqp_u040.npz") as data:
        variant = from_mapping(json.loads(str(data["params_json"])), "firmware")
    ours, theirs = values_of(load_set("autoware-0.40")), values_of(variant)
    differing = {key for key in KNOWN if ours[key] != theirs[key]}
    assert differing == {key for key in KNOWN if key.startswith("vehicle.")} | (
        OURS & {"pass_filters_above_nyquist"}
    ) | exceptions("firmware")


def test_the_default_set() -> None:
    default = load_set("default")
    assert default.node.ctrl_period == 0.15
    assert default.node.ego_nearest_dist_threshold == 3.0
    assert default.node.ego_nearest_yaw_threshold == 1.046
    assert default.lateral.qp_solver_type == "daqp"
    assert with_period(default, 0.03).node.ctrl_period == 0.03


def test_every_difference_between_the_sets_has_its_reason() -> None:
    values = [values_of(load_set(name)) for name in SETS]
    assert set(REASONS) == {key for key in KNOWN if len({v[key] for v in values}) > 1}


def exceptions(name: str) -> set[str]:
    """Keys of the own files that a set changes."""
    own = {f"island/{file}" for file in OWN}
    origins = read([], name).origins
    return {key for key in OWN_KEYS if origins[key].source not in own}


def test_only_the_firmware_set_changes_what_is_our_own() -> None:
    """Each change is one: a value that differs from that of the shared file, with a source."""
    assert [bool(exceptions(name)) for name in SETS] == [True, False, False, False, False]
    ours, theirs = values_of(load_set("default")), values_of(load_set("firmware"))
    assert exceptions("firmware") == {key for key in OWN_KEYS if ours[key] != theirs[key]}
    text = shipped_text("firmware", EXCEPTIONS)
    assert text.startswith("# Set firmware: ") and "# Source: " in text.split("/**:")[0]


@pytest.mark.parametrize("name", SETS)
@pytest.mark.parametrize("file", FILES)
def test_each_file_says_where_its_values_come_from(name: str, file: str) -> None:
    text = shipped_text(name, file)
    whose = "under every parameter set" if file in OWN else f"Set {name}: "
    assert text.startswith("# ") and whose in text.splitlines()[0]
    assert "# Source: " in text.split("/**:")[0]


@pytest.mark.parametrize("name", SETS)
def test_a_set_holds_no_key_without_effect(name: str) -> None:
    assert read([], name).ignored == ()
