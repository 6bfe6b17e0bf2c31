# SPDX-License-Identifier: Apache-2.0
"""What python-can's exceptions and error frames mean for the output."""

from __future__ import annotations

import errno
import termios
from collections.abc import Iterator

import can

from safety_island.can.bus import BusEvent, EventKind
from safety_island.platform.interfaces import CanResult

_BY_ERRNO = {
    errno.ENOBUFS: CanResult.QUEUE_FULL,
    errno.EAGAIN: CanResult.QUEUE_FULL,
    errno.ETIMEDOUT: CanResult.TIMED_OUT,
    errno.ENETDOWN: CanResult.INTERFACE_DOWN,
    errno.ENETUNREACH: CanResult.INTERFACE_DOWN,
    errno.ENODEV: CanResult.INTERFACE_DOWN,
    errno.ENXIO: CanResult.INTERFACE_DOWN,
    errno.EIO: CanResult.INTERFACE_DOWN,
    errno.EBADF: CanResult.INTERFACE_DOWN,
}

# Error classes of an error frame, and the controller's state in its second byte: linux/can/error.h.
_CLASSES = (
    (0x020, EventKind.NOT_ACKNOWLEDGED),
    (0x040, EventKind.BUS_OFF),
    (0x100, EventKind.RESTARTED),
)
_CONTROLLER_CLASS = 0x004
_CONTROLLER_STATES = (
    (0x03, EventKind.OVERFLOW),
    (0x0C, EventKind.ERROR_WARNING),
    (0x30, EventKind.ERROR_PASSIVE),
    (0x40, EventKind.ERROR_ACTIVE),
)


def _chain(error: BaseException | None) -> Iterator[BaseException]:
    while error is not None:
        yield error
        error = error.__cause__ or error.__context__


def _errno(error: BaseException) -> int | None:
    if isinstance(error, can.CanError):
        return error.error_code
    if isinstance(error, termios.error):  # of a serial line, and no OSError
        return int(error.args[0])
    return error.errno if isinstance(error, OSError) else None


def result_of(error: BaseException, budget_is_spent: bool) -> CanResult:
    """Return what kind of failure an exception of ``send`` or ``recv`` is.

    A driver that gives no error number and has used up the budget was waiting for room.
    """
    for link in _chain(error):
        code = _errno(link)
        if code in _BY_ERRNO:
            return _BY_ERRNO[code]
        if isinstance(link, TimeoutError):
            return CanResult.TIMED_OUT
    return CanResult.TIMED_OUT if budget_is_spent else CanResult.FAILED


def reason_of(error: BaseException) -> str:
    """Return the innermost reason of an exception in one line."""
    texts = [str(link) for link in _chain(error) if str(link)]
    return " ".join(texts[-1].split()) if texts else type(error).__name__


def events_of(message: can.Message) -> list[BusEvent]:
    """Return what an error frame tells."""
    bits = message.arbitration_id
    kinds = [kind for mask, kind in _CLASSES if bits & mask]
    if bits & _CONTROLLER_CLASS and len(message.data) > 1:
        kinds += [kind for mask, kind in _CONTROLLER_STATES if message.data[1] & mask]
    return [BusEvent(kind) for kind in kinds]
