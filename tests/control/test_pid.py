# SPDX-License-Identifier: Apache-2.0
"""The PID and the low pass before it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from safety_island.control.longitudinal_state import PID_MEMORY
from safety_island.control.pid import low_pass, pid_reset, pid_step
from safety_island.kernel.records import Records
from tests.control.longitudinal_rig import packed


def memory() -> Records:
    made: Records = np.zeros(1, PID_MEMORY)
    return made


def wide(**overrides: Any) -> Any:
    """Unit gains with every limit at 10."""
    names = ("out", "p_effort", "i_effort", "d_effort")
    limits = {f"max_{name}": 10.0 for name in names} | {f"min_{name}": -10.0 for name in names}
    return packed(**(limits | {"kp": 1.0, "ki": 1.0, "kd": 1.0} | overrides))[0]


def test_terms_are_error_sum_and_slope() -> None:
    p, m = wide(), memory()[0]
    assert pid_step(p, m, 1.5, 1.0, False) == (1.5, 1.5, 0.0, 0.0)
    assert pid_step(p, m, -1.0, 0.5, False) == (-6.0, -1.0, 0.0, -5.0)
    assert pid_step(p, m, 2.0, 0.25, True) == (10.0, 2.0, 0.5, 10.0)
    assert pid_step(p, m, 2.0, 0.25, True) == (3.0, 2.0, 1.0, 0.0)
    assert pid_step(p, m, 2.0, 0.25, False) == (3.0, 2.0, 1.0, 0.0), "the integral rests"


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_each_term_and_the_sum_are_limited(sign: float) -> None:
    p, m = wide(), memory()[0]
    assert pid_step(p, m, sign * 10.0, 10.0, True) == (sign * 10, sign * 10, sign * 10, 0.0)
    assert pid_step(p, m, sign * 99.0, 1.0, True) == (sign * 10, sign * 10, sign * 10, sign * 10)
    assert m.integral == sign * 10.0


def test_the_integral_is_held_in_the_range_of_its_term() -> None:
    p, m = wide(ki=0.1, max_i_effort=0.3, min_i_effort=-0.3), memory()[0]
    for _ in range(9):
        _, _, i_term, _ = pid_step(p, m, 1.0, 1.0, True)
    assert i_term == pytest.approx(0.3, abs=1e-15)
    assert m.integral == pytest.approx(3.0, abs=1e-15)
    _, _, i_term, _ = pid_step(p, m, -1.0, 1.0, True)
    assert i_term == pytest.approx(0.2, abs=1e-15), "it leaves the limit at once"


def test_a_reset_forgets_the_integral_and_the_previous_error() -> None:
    p, m = wide(), memory()[0]
    pid_step(p, m, 4.0, 1.0, True)
    pid_reset(m)
    assert pid_step(p, m, 1.0, 1.0, False) == (1.0, 1.0, 0.0, 0.0)


def test_without_an_integral_gain_nothing_is_collected() -> None:
    p, m = wide(ki=0.0), memory()[0]
    assert pid_step(p, m, 1.0, 1.0, True) == (1.0, 1.0, 0.0, 0.0)
    assert m.integral == 0.0


def test_the_low_pass_keeps_its_gain_of_the_old_value() -> None:
    assert low_pass(0.0, 0.9, 1.0) == pytest.approx(0.1, abs=1e-15)
    assert low_pass(2.0, 0.75, 4.0) == 2.5
