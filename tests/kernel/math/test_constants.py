# SPDX-License-Identifier: Apache-2.0
"""Every number in the maths functions is what mathematics says."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import numpy as np
import pytest

from safety_island.kernel.math import exponential, inverse, reduction, trigonometric
from tests.kernel.math import constants

MODULES: tuple[ModuleType, ...] = (exponential, inverse, reduction, trigonometric)
VALUES = constants.values()


def written(name: str) -> Any:
    (found,) = {id(vars(m)[name]): vars(m)[name] for m in MODULES if name in vars(m)}.values()
    return found


@pytest.mark.parametrize("name", VALUES)
def test_a_constant_is_the_nearest_double(name: str) -> None:
    expected = np.array(VALUES[name])
    assert np.array_equal(np.array(written(name)), expected)


def test_two_over_pi_has_as_many_digits_as_the_largest_double_needs() -> None:
    limbs = [int(limb) for limb in reduction.TWO_OVER_PI_LIMBS]
    assert limbs[:3] == [0, 0, 0]
    number = sum(limb << (26 * place) for place, limb in enumerate(reversed(limbs)))
    assert number == constants.two_over_pi()
    largest_shift = (1024 - 1) // 26
    assert len(limbs) == largest_shift + 8 + 2 + 1 + 1


def test_parts_are_short_enough_for_exact_products() -> None:
    first, second, third = reduction.HALF_PI_PARTS
    assert (first * 2.0**32).is_integer() and first < 2.0
    assert (second * 2.0**65).is_integer() and second < 2.0**-32
    assert 0.0 < third < 2.0**-65
    assert (exponential.LN2[0] * 2.0**40).is_integer()
