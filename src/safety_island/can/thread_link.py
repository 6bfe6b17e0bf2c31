# SPDX-License-Identifier: Apache-2.0
"""The way to a device that may block: a thread that is kept waiting instead of the control loop."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from queue import Empty, SimpleQueue

from safety_island.can.bus import BusDevice, BusEvent, Delivery, MonotonicNs, deliver
from safety_island.can.link import renew
from safety_island.platform.interfaces import CanError, CanFrame, CanResult

OPEN_LIMIT_S = 10.0
"""An adapter may need seconds to wake up."""
CLOSE_LIMIT_S = 0.3
"""A bus that blocks must not delay the end of the process."""


class _Job:
    """One command on its way through the thread."""

    def __init__(self, frames: Sequence[CanFrame], deadline_ns: int) -> None:
        self.frames = frames
        self.deadline_ns = deadline_ns
        self.finished = threading.Event()
        self.is_abandoned = False
        self.index = 0
        self.delivery = Delivery(0, CanResult.FAILED)

    def may_go_on(self, index: int) -> bool:
        """Note the frame that is next, and tell whether it may still leave."""
        self.index = index
        return not self.is_abandoned


class ThreadLink:
    """For any device: one thread, which sleeps between commands, opens it and sends with it.

    A command that is not through within its budget is abandoned. None of its frames leaves after
    that, except one that the device may be blocked in, which no receiver can complete. As long as
    the device blocks, each further command fails at once.
    """

    def __init__(self, device: BusDevice, clock: MonotonicNs) -> None:
        self.device = device
        self.is_opening = False
        self._clock = clock
        self._is_open = False
        self._job: _Job | None = None
        self._polled: SimpleQueue[Sequence[BusEvent]] = SimpleQueue()
        self._is_polling = False
        self._tasks: SimpleQueue[Callable[[], None] | None] = SimpleQueue()
        self._thread = threading.Thread(target=self._run, name="can", daemon=True)

    def open(self) -> None:
        """Open the device. Raises CanError, also when that takes too long."""
        opened: SimpleQueue[CanError | None] = SimpleQueue()
        self._thread.start()
        self._tasks.put(lambda: opened.put(self._open_first()))
        try:
            error = opened.get(timeout=OPEN_LIMIT_S)
        except Empty:
            error = CanError(
                f"the CAN device did not open within {OPEN_LIMIT_S:g} s: is the adapter awake?"
            )
        if error is not None:
            raise error

    def send(self, frames: Sequence[CanFrame], budget_s: float) -> Delivery:
        """Deliver the frames within the budget [s], or give up."""
        if self._job is not None and not self._job.finished.is_set():
            return Delivery(0, CanResult.TIMED_OUT)
        if not self._is_open:
            return Delivery(0, CanResult.NOT_OPEN)
        job = self._job = _Job(frames, self._clock() + int(budget_s * 1e9))
        self._tasks.put(lambda: self._deliver(job))
        if not job.finished.wait(budget_s):
            job.is_abandoned = True
            # It may have come through between the two lines above: then it is sent.
            if not job.finished.is_set():
                return Delivery(job.index, CanResult.TIMED_OUT)
        return job.delivery

    def poll(self) -> Sequence[BusEvent]:
        """Return what the thread found when it was last asked, and ask it again."""
        if self._is_polling:
            try:
                events = self._polled.get_nowait()
            except Empty:
                return ()
        else:
            events = ()
        self._is_polling = self._is_open
        if self._is_open:
            self._tasks.put(lambda: self._polled.put(self.device.poll()))
        return events

    def discard(self) -> None:
        """Throw away what waits to be sent, before the next command."""
        self._tasks.put(self.device.discard)

    def reopen(self) -> None:
        """Close and open again, as soon as the device lets the thread go."""
        self._is_open, self.is_opening = False, True
        self._tasks.put(self._renew)

    def close(self) -> None:
        """End the thread, which closes the device; wait for it a moment only."""
        self._is_open = False
        self._tasks.put(None)
        if self._thread.is_alive():
            self._thread.join(CLOSE_LIMIT_S)

    def _run(self) -> None:
        while (task := self._tasks.get()) is not None:
            task()
        self.device.close()

    def _open_first(self) -> CanError | None:
        try:
            self.device.open()
        except CanError as error:
            return error
        self._is_open = True
        return None

    def _renew(self) -> None:
        self._is_open = renew(self.device)
        self.is_opening = False

    def _deliver(self, job: _Job) -> None:
        job.delivery = deliver(self.device, job.frames, job.deadline_ns, self._clock, job.may_go_on)
        job.finished.set()
