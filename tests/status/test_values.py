# SPDX-License-Identifier: Apache-2.0
"""A status as JSON: names for numbers, null for what has no value."""

from __future__ import annotations

import json
from typing import Any

from hypothesis import given, settings

from safety_island.input_gate.reason import SampleReason
from safety_island.messages import codec
from safety_island.messages.status import STATUS, decode_status
from safety_island.status.names import guard_limits_of
from safety_island.status.values import status_values
from tests.messages.samples import status_of_nothing
from tests.messages.strategies import messages
from tests.status.samples import NOT_FINITE, ODOMETRY, STALE, sample


def test_numbers_of_enumerations_have_their_names() -> None:
    values = status_values(sample({ODOMETRY: NOT_FINITE | {"warnings": 1}}, **STALE))
    wanted = {
        "state": "SILENT",
        "reason": "INPUT_STALE",
        "subject": "odometry",
        "latched_cause": "INPUT_STALE",
        "operation_mode": "AUTONOMOUS",
        "longitudinal_state": "DRIVE",
        "mpc_status": "SOLVED",
        "output_mode": "DDS_ONLY",
        "arm_result": "NONE",
        "guard_verdict": "PASSED",
        "controller_limits": ["STEERING_RATE", "JERK"],
    }
    assert {name: values[name] for name in wanted} == wanted
    odometry = values["inputs"]["odometry"]
    assert odometry["refused"] == {"NOT_FINITE": 3}
    assert odometry["last_refusal"] == SampleReason.NOT_FINITE.name
    assert odometry["warnings"] == ["AGE"]
    assert odometry["writer_guid"] == "01" * 16
    assert odometry["age_s"] == 0.62
    assert (values["tick_s"], values["memory_bytes"]) == (0.00098, 125_000_000)


def test_what_has_no_value_is_null() -> None:
    values = status_values(status_of_nothing())
    none = ("subject", "mpc_status", "longitudinal_state", "guard_verdict", "lateral_error")
    assert [values[name] for name in (*none, "steering_tire_angle")] == [None] * 6
    trajectory = values["inputs"]["trajectory"]
    names = ("age_s", "age_limit_s", "transport_delay_s", "writer_guid", "last_refusal")
    assert [trajectory[name] for name in names] == [None] * 5


def test_numbers_of_a_newer_island_keep_their_digits() -> None:
    values = status_values(sample(state=99, guard_verdict=9, controller_limits=1 << 31 | 1))
    assert (values["state"], values["guard_verdict"]) == ("99", "9")
    assert values["controller_limits"] == ["STEERING_ANGLE", "bit 31"]
    assert guard_limits_of(1 << 30) == ["bit 30"]


def test_the_operation_mode_has_the_name_of_its_input() -> None:
    assert list(status_values(sample())["inputs"])[-1] == "operation mode"


@settings(max_examples=100, deadline=None)
@given(messages(STATUS))
def test_whatever_comes_is_json(message: dict[str, Any]) -> None:
    values = status_values(decode_status(codec.encode(STATUS, message)))
    assert json.loads(json.dumps(values, allow_nan=False)).keys() == values.keys()
