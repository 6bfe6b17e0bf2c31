"""What the controllers did arrives in the status."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from safety_island.control.records import TRACE
from safety_island.control.status import ControllerLimit, LongitudinalState, MpcStatus
from safety_island.messages.status import StatusWriter, decode_status
from safety_island.messages.status_fields import Status
from safety_island.node.trace_status import FLAGS, VALUES, TraceStatus


@pytest.fixture
def trace() -> Any:
    """A trace with a different number in every field that is copied."""
    made = np.zeros(1, TRACE)
    for number, name in enumerate(VALUES.values()):
        made[name] = number + 1
    made["lon_state"], made["mpc_status"] = LongitudinalState.STOPPED, MpcStatus.INFEASIBLE
    return made


def status_of(trace: Any) -> Status:
    writer = StatusWriter()
    TraceStatus(trace, writer).fill()
    return decode_status(writer.encode())


def test_values_are_copied(trace: Any) -> None:
    status = status_of(trace)
    assert {to: getattr(status, to) for to in VALUES} == {
        to: trace[name][0].item() for to, name in VALUES.items()
    }


@pytest.mark.parametrize("limit", ControllerLimit)
def test_each_flag_has_its_bit(trace: Any, limit: ControllerLimit) -> None:
    trace[FLAGS[limit]] = True
    assert ControllerLimit(status_of(trace).controller_limits) is limit


def test_it_follows_the_memory_of_the_trace(trace: Any) -> None:
    writer = StatusWriter()
    filler = TraceStatus(trace, writer)
    trace["lateral_error"], trace["angle_limited"], trace["jerk_limited"] = -2.5, True, True
    filler.fill()
    found = decode_status(writer.encode())
    assert found.lateral_error == -2.5
    assert found.controller_limits == ControllerLimit.STEERING_ANGLE | ControllerLimit.JERK
    filler.clear()
    found = decode_status(writer.encode())
    assert (found.lateral_error, found.controller_limits) == (-2.5, 0)
