"""The island's own status: written through cells of one record, whose bytes are the message."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from safety_island.messages import wire
from safety_island.messages.description import Primitive
from safety_island.messages.fixed import cells, packer, record_type, rows_packer
from safety_island.messages.framed import little_endian
from safety_island.messages.registry import struct_of
from safety_island.messages.status_fields import InputStatus, Status
from safety_island.messages.wire import HEADER_LE, HEADER_SIZE, Time

STATUS = "safety_island_msgs/msg/Status"
INPUT_STATUS = "safety_island_msgs/msg/InputStatus"
NO_VALUE = 255
"""Of an enumeration for which there is no value (yet)."""

STATUS_RECORD = record_type(STATUS)
"""One status, as C lays it out."""
INPUT_RECORD = record_type(INPUT_STATUS)
SIZE = HEADER_SIZE + STATUS_RECORD.itemsize
"""Of a status on the wire [byte]."""
_ALIGNMENT = 8
_UNKNOWN = ("lateral_error", "yaw_error", "residual", "stop_dist", "target_vel")
_COMMAND = ("command_angle", "command_rate", "command_velocity", "command_acceleration")
_NO_CHOICE = ("subject", "longitudinal_state", "mpc_status", "guard_verdict")


class StatusWriter:
    """Memory of one status that is written anew each tick.

    ``fields`` has a view of each field, under the names of the IDL file: ``fields.tick[0] = 7``,
    ``fields.stamp.sec[0] = 1``. ``inputs`` has those of each input, in the order of the message:
    ``inputs[1].age[0] = 0.1``, ``inputs[1].refused[reason] += 1``. A value stays until it is
    written again, so that counts live here. ``pack`` and ``pack_inputs`` give functions that
    write many fields at once. ``record`` is all of it, shape (1,).
    """

    def __init__(self) -> None:
        memory = np.zeros(_ALIGNMENT + STATUS_RECORD.itemsize, np.uint8)
        self.record: npt.NDArray[Any] = memory[_ALIGNMENT:].view(STATUS_RECORD)
        self._memory = memory.data[_ALIGNMENT:]
        self.fields: Any = cells(self._memory, STATUS_RECORD)
        self.inputs: tuple[Any, ...] = self.fields.inputs
        self._message = memory[_ALIGNMENT - HEADER_SIZE :]
        self._message[:HEADER_SIZE] = tuple(HEADER_LE)
        self._clear()

    def pack(self, *names: str) -> Callable[..., None]:
        """Return a function that writes these fields, neighbours in the message, at once.

        Keep it: it is three times as quick a field as ``fields``. See ``fixed.packer``.
        """
        return packer(self._memory, STATUS_RECORD, *names)

    def pack_inputs(self) -> Callable[..., None]:
        """Return a function that writes all fields of all inputs at once.

        Their order is that of the message; ``refused`` and ``writer_guid`` are given as bytes.
        """
        return rows_packer(self._memory, STATUS_RECORD, "inputs")

    def encode(self) -> bytes:
        """Return the message, header included."""
        return self._message.tobytes()

    def _clear(self) -> None:
        """Say of everything that has no value yet that it has none."""
        for name in (*_UNKNOWN, *_COMMAND):
            getattr(self.fields, name)[0] = math.nan
        for name in _NO_CHOICE:
            getattr(self.fields, name)[0] = NO_VALUE
        for item in self.inputs:
            item.age[0] = item.age_limit[0] = math.inf
            item.transport_delay[0] = math.nan
            item.last_refusal[0] = NO_VALUE


def decode_status(data: bytes) -> Status:
    """Return the status of a safety_island_msgs/msg/Status; DecodeError when it is none.

    Enumerations are numbers, so that those of a newer island can be read.
    """
    data = little_endian(data, STATUS)
    wire.check_end(data, SIZE, STATUS)
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
