# SPDX-License-Identifier: Apache-2.0
"""The record of the guard's parameters, from the parameters as a file gives them."""

from __future__ import annotations

from dataclasses import fields

import pytest

from safety_island.core.guard import pack_guard
from safety_island.guard import GuardParams
from safety_island.guard.records import LISTS, MAX_SPEED_POINTS
from safety_island.params import load_set
from tests.guard.rig import limited


def test_every_parameter_is_in_the_record() -> None:
    limits = load_set("default").guard
    packed = pack_guard(limits, 2.75, 0.25)[0]
    assert (packed.points, packed.wheel_base, packed.timeout) == (5, 2.75, 0.25)
    for item in fields(GuardParams):
        value = getattr(limits, item.name)
        if item.name in LISTS:
            found = packed[item.name].tolist()
            assert found == [*value, *[0.0] * (MAX_SPEED_POINTS - len(value))], item.name
        else:
            assert packed[item.name] == value, item.name


MANY = (1.0,) * (MAX_SPEED_POINTS + 1)


@pytest.mark.parametrize(
    ("wrong", "found"),
    [
        ({"jerk": (1.0, 2.0, 3.0)}, "3 in jerk"),
        ({"speed_points": (0.0, 5.0, 10.0)}, "3 in speed_points, 2 in steering_angle"),
        (dict.fromkeys(LISTS, MANY), "33 in speed_points"),
        (dict.fromkeys(LISTS, ()), "0 in speed_points"),
    ],
    ids=["one longer", "speeds longer", "too long", "empty"],
)
def test_lists_that_do_not_fit_make_no_record(
    wrong: dict[str, tuple[float, ...]], found: str
) -> None:
    with pytest.raises(ValueError, match=rf"found .*{found}.*; expected as many in each, 1 to 32"):
        pack_guard(limited(**wrong), 2.75, 0.25)
