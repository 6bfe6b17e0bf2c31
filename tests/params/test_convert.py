# SPDX-License-Identifier: Apache-2.0
"""Types, ranges and misspelt keys."""

from __future__ import annotations

import math
from typing import Any

import pytest

from safety_island.control.limits import MAX_RATE_TABLE
from safety_island.guard.records import MAX_SPEED_POINTS
from safety_island.params.convert import NotAllowedError, convert, nearest
from safety_island.params.schema import KNOWN


@pytest.mark.parametrize(
    ("key", "value", "result"),
    [
        ("input_delay", 1, 1.0),
        ("input_delay", 0.24, 0.24),
        ("mpc_prediction_horizon", 50, 50),
        ("enable_smooth_stop", True, True),
        ("qp_solver_type", "osqp", "osqp"),
        ("curvature_list_for_steer_rate_lim", [0, 0.5], (0.0, 0.5)),
        ("curvature_list_for_steer_rate_lim", (0.1,), (0.1,)),
    ],
)
def test_allowed(key: str, value: Any, result: Any) -> None:
    converted = convert(KNOWN[key], value)
    assert converted == result
    assert type(converted) is type(result)


@pytest.mark.parametrize(
    ("key", "value", "part"),
    [
        ("input_delay", True, "found true (a switch); expected a number from 0 to 5 s"),
        ("input_delay", "0.2", "found the text '0.2'; expected a number"),
        ("input_delay", None, "found nothing"),
        ("input_delay", [0.2], "found [0.2]"),
        ("input_delay", {}, "found a map"),
        ("input_delay", math.nan, "found nan"),
        ("input_delay", math.inf, "found inf"),
        ("input_delay", -0.001, "found -0.001"),
        ("input_delay", 10**400, "found 1000"),
        ("mpc_prediction_horizon", 50.0, "found 50.0 (a number); expected a whole number"),
        ("mpc_prediction_horizon", True, "found true"),
        ("mpc_prediction_horizon", 1, "expected a whole number from 2 to 64 steps"),
        ("enable_smooth_stop", 1, "found 1 (a whole number); expected true or false"),
        ("enable_smooth_stop", "true", "found the text 'true'; expected true or false"),
        ("qp_solver_type", "qpoases", "expected one of unconstraint_fast, osqp, daqp"),
        ("qp_solver_type", ["osqp"], "found [osqp]"),
        ("curvature_list_for_steer_rate_lim", 0.1, "found 0.1 (a number); expected a list"),
        ("curvature_list_for_steer_rate_lim", [], "found []; expected a list of 1 to 32 numbers"),
        ("curvature_list_for_steer_rate_lim", [0.1] * (MAX_RATE_TABLE + 1), "a list of 1 to 32"),
        ("curvature_list_for_steer_rate_lim", [0.1, math.nan], "found nan"),
        ("guard.jerk", [1.0] * (MAX_SPEED_POINTS + 1), "expected a list of 1 to 32 numbers"),
        ("curvature_list_for_steer_rate_lim", [[0.1]], "found [0.1]"),
    ],
)
def test_not_allowed(key: str, value: Any, part: str) -> None:
    with pytest.raises(NotAllowedError) as caught:
        convert(KNOWN[key], value)
    assert part in str(caught.value)


@pytest.mark.parametrize(
    ("key", "meant"),
    [
        ("mpc_weigth_lat_error", "mpc_weight_lat_error"),
        ("Input_delay", "input_delay"),
        ("average_num", "steering_offset.average_num"),
        ("max_acc_cmd_diff_rate", "max_acc_cmd_diff"),
        ("kpp", "kp"),
    ],
)
def test_the_nearest_key_of_a_typo(key: str, meant: str) -> None:
    assert nearest(key) == meant


def test_equally_near_keys_are_all_named() -> None:
    assert set(nearest("kq").split(" or ")) == {"kp", "ki", "kd"}


def test_no_hint_for_what_is_like_nothing() -> None:
    assert nearest("zzzzqqqq") == ""
