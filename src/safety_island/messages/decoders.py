# SPDX-License-Identifier: Apache-2.0
"""The five inputs decoded by the kernels of the input gate, as messages; no rule stands here."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import numpy as np

from safety_island.input_gate.decode import records
from safety_island.input_gate.decode.records import BODY, MAX_SAMPLE, START, new_sample
from safety_island.input_gate.reason import GOOD
from safety_island.kernel.cdr import DecodeReason
from safety_island.kernel.kernel import Entry
from safety_island.kernel.records import Records, cells
from safety_island.messages import wire
from safety_island.messages.errors import DecodeError
from safety_island.messages.fixed import reader
from safety_island.messages.points import POINT, Points

_BOUND = 2
"""Arrays of points that a kernel is kept bound to: a follower has two, which change places."""


class InputDecoders:
    """Decodes one sample at a time, in memory of its own; not for two threads at once.

    Each method raises DecodeError for whatever is not a whole message. Values are not judged.
    """

    def __init__(self) -> None:
        from safety_island.input_gate.decode import inputs as kernels  # loads the compiler

        self._sample = new_sample()
        memory: Any = self._sample.view(np.uint8).data
        self._bytes = memory[records.SAMPLE.fields["bytes"][1] :]
        cell = cells(self._sample)
        self._size, self._found = cell["n_bytes"], cell["found"]
        self._odometry = self._decoder(kernels.decode_odometry, records.ODOMETRY)
        self._steering = self._decoder(kernels.decode_steering, records.STEERING)
        self._acceleration = self._decoder(kernels.decode_acceleration, records.ACCELERATION)
        self._mode = self._decoder(kernels.decode_operation_mode, records.OPERATION_MODE)
        self._trajectories: Records = np.zeros(1, records.TRAJECTORY)
        self._head = kernels.decode_trajectory.bind(self._sample, self._trajectories)
        self._read_head = reader(self._trajectories, *records.TRAJECTORY.names)
        self._copy_points = kernels.copy_points
        self._copy_points.prepare()
        self._copiers: list[tuple[Points, Callable[[], int]]] = []

    def _decoder(
        self, kernel: Entry, kind: Any
    ) -> tuple[Callable[[], int], Callable[[], tuple[Any, ...]]]:
        """Return the kernel of a kind of message, and what reads the record that it fills."""
        filled: Records = np.zeros(1, kind)
        return kernel.bind(self._sample, filled), reader(filled, *kind.names)

    def odometry(self, data: bytes, type_name: str) -> tuple[Any, ...]:
        """Return stamp (2), both frames, pose (7) and velocity (6)."""
        kernel, read = self._odometry
        self._run(kernel, data, type_name)
        sec, nanosec, at, size, child_at, child_size, *numbers = read()
        return sec, nanosec, _text(data, at, size), _text(data, child_at, child_size), *numbers

    def steering(self, data: bytes, type_name: str) -> tuple[Any, ...]:
        """Return stamp (2) and angle."""
        kernel, read = self._steering
        self._run(kernel, data, type_name)
        return read()

    def acceleration(self, data: bytes, type_name: str) -> tuple[Any, ...]:
        """Return stamp (2), frame and accelerations (6)."""
        kernel, read = self._acceleration
        self._run(kernel, data, type_name)
        sec, nanosec, at, size, *numbers = read()
        return sec, nanosec, _text(data, at, size), *numbers

    def operation_mode(self, data: bytes, type_name: str) -> tuple[Any, ...]:
        """Return stamp (2), mode and flags (6)."""
        kernel, read = self._mode
        self._run(kernel, data, type_name)
        return read()

    def trajectory(self, data: bytes, out: Points | None, type_name: str) -> tuple[Any, ...]:
        """Return stamp (2), frame, points and first time (2).

        The points are copied into ``out``, else into a new array.
        """
        self._run(self._head, data, type_name)
        sec, nanosec, at, size, n, _, *first = self._read_head()
        if out is None:
            out = np.empty(max(n, 1), POINT)  # a kernel takes no array of nothing
            reason = self._copy_points.call(self._sample, self._trajectories, out)
        else:
            reason = self._copier(out)()
        if reason != GOOD:
            raise self._error(reason, data, type_name, len(out), "points")
        return sec, nanosec, _text(data, at, size), out[:n], *first

    def _run(self, kernel: Callable[[], int], data: bytes, type_name: str) -> None:
        size = len(data)
        self._size[0] = size
        if size <= MAX_SAMPLE:
            self._bytes[START : START + size] = data
        else:  # the kernel refuses it by its size, or by its header
            self._bytes[START:BODY] = data[: BODY - START]
        if (reason := kernel()) != GOOD:
            raise self._error(reason, data, type_name, MAX_SAMPLE, "bytes")

    def _copier(self, out: Points) -> Callable[[], int]:
        """Return the kernel that copies the points into an array."""
        for points, copier in self._copiers:
            if points is out:
                return copier
        copier = self._copy_points.bind(self._sample, self._trajectories, out)
        self._copiers = [*self._copiers[1 - _BOUND :], (out, copier)]
        return copier

    def _error(self, reason: int, data: bytes, type_name: str, most: int, what: str) -> DecodeError:
        """Return the error for a reason; ``most`` are taken of ``what`` is too many."""
        found = self._found[0]
        if reason == DecodeReason.ENCAPSULATION:
            return wire.other_encapsulation(type_name, data)
        if reason == DecodeReason.TRUNCATED:
            return wire.truncated(type_name, found, len(data))
        if reason == DecodeReason.LENGTH:
            detail = f"{found} {what}, at most {most} are taken"
            return DecodeError(DecodeReason.LENGTH, type_name, detail)
        if reason == DecodeReason.STRING:
            return wire.no_string(type_name)
        if reason == DecodeReason.BOOLEAN:
            return wire.no_boolean(type_name, found)
        return wire.trailing(type_name, found)


def _text(data: bytes, at: int, size: int) -> str:
    """Return the text of a sample that stands at a place of the kernels' memory."""
    return str(data[at - START : at - START + size], "utf-8")


class _PerThread(threading.local):
    decoders: InputDecoders | None = None


_per_thread = _PerThread()


def decoders() -> InputDecoders:
    """Return those of this thread, made when they are asked for first."""
    found = _per_thread.decoders
    if found is None:
        found = _per_thread.decoders = InputDecoders()
    return found
