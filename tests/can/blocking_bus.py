# SPDX-License-Identifier: Apache-2.0
"""A device that blocks when it is told to, as a driver does that ignores its time-out."""

from __future__ import annotations

import threading
from collections.abc import Sequence

from safety_island.can.bus import BusEvent
from safety_island.can.mock import MockBus
from safety_island.platform.interfaces import CanError, CanFrame, CanResult
from tests.can.rig import LIMIT_S


class BlockingBus(MockBus):
    """``gate`` closed: ``send`` and ``open`` wait until it opens."""

    def __init__(self) -> None:
        super().__init__()
        self.gate = threading.Event()
        self.gate.set()
        self.is_waiting = threading.Event()
        self.closed = threading.Event()
        self.poll_result: Sequence[BusEvent] = ()

    def open(self) -> None:
        self._wait()
        super().open()

    def send(self, frame: CanFrame, budget_s: float) -> CanResult:
        self._wait()
        return super().send(frame, budget_s)

    def close(self) -> None:
        super().close()
        self.closed.set()

    def _wait(self) -> None:
        if not self.gate.is_set():
            self.is_waiting.set()
            if not self.gate.wait(LIMIT_S):
                raise CanError("the gate stayed closed")
            self.is_waiting.clear()
