# SPDX-License-Identifier: Apache-2.0
"""Every parameter says what it is."""

from __future__ import annotations

import math

import pytest

from safety_island.control.records import PARAMS, pack_parameters
from safety_island.params import SETS, load_set
from safety_island.params.schema import KNOWN, Known, assemble, values_of
from tests.params.files import OWN_KEYS

FREE_TEXTS = {"gate.map_frame", "gate.base_frame"}
"""Names that the vehicle chooses."""

ALL = pytest.mark.parametrize("known", KNOWN.values(), ids=list(KNOWN))


@ALL
def test_every_parameter_has_a_meaning_and_a_range(known: Known) -> None:
    assert known.doc.endswith(".") and "\n" not in known.doc and len(known.doc) > 10
    if known.kind in ("float", "int", "list"):
        assert math.isfinite(known.low) and math.isfinite(known.high) and known.low < known.high
    if known.kind == "str":
        assert bool(known.choices) != (known.key in FREE_TEXTS)


@ALL
def test_every_dimension_has_a_unit(known: Known) -> None:
    plain = (
        "weight",
        "gain",
        "kd",
        "enable_",
        "use_",
        "extend_",
        "keep_",
        "correct_",
        "pass_",
        "_ratio",
        "ff_scale_",
    )
    is_plain = known.kind in ("bool", "str") or any(word in known.key for word in plain)
    assert bool(known.unit) != is_plain


def test_keys_are_autowares_with_dots() -> None:
    assert KNOWN["steering_offset.average_num"].name == "steering_offset_average_num"
    assert KNOWN["vehicle.cf"].name == "vehicle_cf"
    theirs = {key: known for key, known in KNOWN.items() if key not in OWN_KEYS}
    assert all(known.name == key.replace(".", "_") for key, known in theirs.items())


def test_our_own_keys_begin_with_their_group() -> None:
    """And hold the words of the field, in an order that reads well in a file."""
    for key in OWN_KEYS:
        group, _, rest = key.partition(".")
        assert group == KNOWN[key].group
        assert sorted(rest.replace(".", "_").split("_")) == sorted(KNOWN[key].name.split("_"))


@pytest.mark.parametrize("name", SETS)
def test_a_set_goes_apart_and_together_again(name: str) -> None:
    parameters = load_set(name)
    assert assemble(values_of(parameters)) == parameters


@pytest.mark.parametrize("name", SETS)
def test_a_set_fits_the_record_of_the_kernels(name: str) -> None:
    packed = pack_parameters(load_set(name))
    assert packed.dtype == PARAMS
    assert packed[0]["wheel_base"] == 2.74
    assert packed[0]["velocity_list_for_steer_rate_lim_size"] == 3
