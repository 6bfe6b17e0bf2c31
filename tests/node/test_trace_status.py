# SPDX-License-Identifier: Apache-2.0
"""What the controllers did arrives in the status."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from safety_island.control.records import TRACE
from safety_island.control.status import ControllerLimit, LongitudinalState, MpcStatus
from safety_island.messages.status import NO_VALUE
from safety_island.node.trace_status import COLUMNS, FLAGS, Traced, TraceStatus


@pytest.fixture
def trace() -> Any:
    """A trace with a different number in every field that is copied."""
    made = np.zeros(1, TRACE)
    for number, name in enumerate(COLUMNS.values()):
        made[name] = number + 1
    made["lon_state"], made["mpc_status"] = LongitudinalState.STOPPED, MpcStatus.INFEASIBLE
    return made


def read(trace: Any) -> Traced:
    status = TraceStatus(trace)
    status.read()
    return status.last


def test_values_are_copied(trace: Any) -> None:
    errors, solver, states, _ = read(trace)
    assert [*errors, *solver, *states] == [trace[name][0].item() for name in COLUMNS.values()]


@pytest.mark.parametrize("limit", ControllerLimit)
def test_each_flag_has_its_bit(trace: Any, limit: ControllerLimit) -> None:
    trace[FLAGS[limit]] = True
    assert ControllerLimit(read(trace).limits) is limit


def test_it_follows_the_memory_of_the_trace(trace: Any) -> None:
    status = TraceStatus(trace)
    trace["lateral_error"], trace["angle_limited"], trace["jerk_limited"] = -2.5, True, True
    status.read()
    assert status.last.errors[0] == -2.5
    assert status.last.limits == ControllerLimit.STEERING_ANGLE | ControllerLimit.JERK
    status.clear()
    assert (status.last.errors[0], status.last.limits) == (-2.5, 0)


def test_before_the_first_tick_nothing_is_known(trace: Any) -> None:
    status = TraceStatus(trace)
    status.clear()
    assert all(map(math.isnan, status.last.errors))
    assert (status.last.solver, status.last.states) == ((0, 0, 0), (NO_VALUE, NO_VALUE))
