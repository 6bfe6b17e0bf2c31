# SPDX-License-Identifier: Apache-2.0
"""The island's own status: all of its values become the message in one stroke."""

from __future__ import annotations

from functools import partial
from itertools import chain
from struct import Struct
from typing import Any

import numpy as np

from safety_island.kernel.cdr import HEADER_SIZE
from safety_island.messages import wire
from safety_island.messages.codec import of_size
from safety_island.messages.description import Primitive
from safety_island.messages.fixed import layout, record_type
from safety_island.messages.registry import struct_of
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

encode_values = partial(_MESSAGE.pack, HEADER_LE)
"""Return the message of all its values in order, those of the stamp and of each input in between.

``refused`` is given as bytes. struct.error or OverflowError for a value that does not fit.
"""


def encode_status(status: Status) -> bytes:
    """Return a safety_island_msgs/msg/Status."""
    counts = INPUT_RECORD["refused"].base
    rows = [(np.array(row.refused, counts).tobytes(), *row[1:]) for row in status.inputs]
    return encode_values(*status.stamp, *status[1:-1], *chain.from_iterable(rows))


def decode_status(data: bytes) -> Status:
    """Return the status of a safety_island_msgs/msg/Status; DecodeError when it is none.

    Enumerations are numbers, so that those of a newer island can be read.
    """
    data = of_size(data, SIZE, STATUS)
    record = np.frombuffer(data, STATUS_RECORD, 1, HEADER_SIZE)
    for place in _FLAGS:
        wire.read_bool(data[HEADER_SIZE + place], STATUS)
    stamp, *values, rows = record.item()
    return Status._make((Time(*stamp), *values, tuple(_input(row) for row in rows)))


def _input(row: Any) -> InputStatus:
    refused, guid, *values = row.item()
    return InputStatus._make((tuple(refused.tolist()), bytes(guid), *values))


_FLAGS = [
    STATUS_RECORD.fields[field.name][1]
    for field in struct_of(STATUS).fields
    if field.type is Primitive.BOOLEAN
]
"""Places of the flags in the record."""
