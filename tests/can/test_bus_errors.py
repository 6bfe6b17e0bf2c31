# SPDX-License-Identifier: Apache-2.0
"""What exceptions and error frames of python-can mean."""

from __future__ import annotations

import errno
import termios

import can
import pytest

from safety_island.can.bus import EventKind
from safety_island.can.bus_errors import events_of, reason_of, result_of
from safety_island.platform.interfaces import CanResult


def caused(outer: Exception, inner: Exception) -> Exception:
    outer.__cause__ = inner
    return outer


@pytest.mark.parametrize(
    ("error", "result"),
    [
        (can.CanOperationError("Failed to transmit", errno.ENOBUFS), CanResult.QUEUE_FULL),
        (can.CanOperationError("Failed to transmit", errno.ENETDOWN), CanResult.INTERFACE_DOWN),
        (can.CanOperationError("Failed to transmit", errno.ENODEV), CanResult.INTERFACE_DOWN),
        (caused(can.CanOperationError("no"), OSError(errno.EIO, "")), CanResult.INTERFACE_DOWN),
        (caused(can.CanOperationError("no"), OSError(errno.EAGAIN, "")), CanResult.QUEUE_FULL),
        (caused(OSError("port"), termios.error(errno.EIO, "")), CanResult.INTERFACE_DOWN),
        (can.CanTimeoutError(), CanResult.TIMED_OUT),
        (caused(can.CanOperationError("no"), TimeoutError()), CanResult.TIMED_OUT),
        (can.CanOperationError("a vendor's own", 0x123456), CanResult.FAILED),
        (ValueError("filedescriptor out of range in select()"), CanResult.FAILED),
    ],
)
def test_exceptions(error: Exception, result: CanResult) -> None:
    assert result_of(error, budget_is_spent=False) is result


def test_without_a_number_a_spent_budget_means_waiting() -> None:
    error = can.CanOperationError("Transmit buffer full")
    assert result_of(error, budget_is_spent=True) is CanResult.TIMED_OUT
    assert result_of(error, budget_is_spent=False) is CanResult.FAILED


def test_the_innermost_reason_in_one_line() -> None:
    inner = OSError(errno.ENOENT, "No such file\nor directory")
    assert reason_of(caused(can.CanInitializationError("oh"), inner)) == (
        "[Errno 2] No such file or directory"
    )
    assert reason_of(can.CanTimeoutError()) == "CanTimeoutError"


def error_frame(bits: int, *data: int) -> can.Message:
    return can.Message(arbitration_id=bits, is_error_frame=True, data=data, is_extended_id=False)


@pytest.mark.parametrize(
    ("frame", "kinds"),
    [
        (error_frame(0x040), [EventKind.BUS_OFF]),
        (error_frame(0x100), [EventKind.RESTARTED]),
        (error_frame(0x020), [EventKind.NOT_ACKNOWLEDGED]),
        (error_frame(0x004, 0, 0x20), [EventKind.ERROR_PASSIVE]),
        (error_frame(0x004, 0, 0x10), [EventKind.ERROR_PASSIVE]),
        (error_frame(0x004, 0, 0x08), [EventKind.ERROR_WARNING]),
        (error_frame(0x004, 0, 0x04), [EventKind.ERROR_WARNING]),
        (error_frame(0x004, 0, 0x40), [EventKind.ERROR_ACTIVE]),
        (error_frame(0x004, 0, 0x02), [EventKind.OVERFLOW]),
        (error_frame(0x044, 0, 0x20), [EventKind.BUS_OFF, EventKind.ERROR_PASSIVE]),
        (error_frame(0x004), []),
        (error_frame(0x088, 0, 0x20), []),
    ],
)
def test_error_frames(frame: can.Message, kinds: list[EventKind]) -> None:
    assert [event.kind for event in events_of(frame)] == kinds
