# SPDX-License-Identifier: Apache-2.0
"""The island's own status: its layout, and its values as Python has them."""

from __future__ import annotations

from itertools import chain
from struct import Struct
from typing import Any

import numpy as np

from safety_island.kernel.cdr import HEADER_SIZE
from safety_island.messages.codec import of_size
from safety_island.messages.fixed import check_flags, layout, record_type
from safety_island.messages.status_fields import InputStatus, Status
from safety_island.messages.wire import HEADER_LE, Time

STATUS = "safety_island_msgs/msg/Status"
INPUT_STATUS = "safety_island_msgs/msg/InputStatus"
NO_VALUE = 255
"""Of an enumeration for which there is no value (yet)."""

STATUS_RECORD = record_type(STATUS)
"""One status, as C lays it out."""
INPUT_RECORD = record_type(INPUT_STATUS)
_MESSAGE = Struct("<4s" + layout(STATUS_RECORD))
SIZE = _MESSAGE.size
"""Of a status on the wire [byte]."""


def encode_status(status: Status) -> bytes:
    """Return a safety_island_msgs/msg/Status; struct.error for a value that does not fit."""
    counts = INPUT_RECORD["refused"].base
    rows = [(np.array(row.refused, counts).tobytes(), *row[1:]) for row in status.inputs]
    return _MESSAGE.pack(HEADER_LE, *status.stamp, *status[1:-1], *chain.from_iterable(rows))


def decode_status(data: bytes) -> Status:
    """Return the status of a safety_island_msgs/msg/Status; DecodeError when it is none.

    Enumerations are numbers, so that those of a newer island can be read.
    """
    data = of_size(data, SIZE, STATUS)
    record = np.frombuffer(data, STATUS_RECORD, 1, HEADER_SIZE)
    check_flags(data, STATUS_RECORD, STATUS)
    stamp, *values, rows = record.item()
    return Status._make((Time(*stamp), *values, tuple(_input(row) for row in rows)))


def _input(row: Any) -> InputStatus:
    refused, guid, *values = row.item()
    return InputStatus._make((tuple(refused.tolist()), bytes(guid), *values))
