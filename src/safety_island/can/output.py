# SPDX-License-Identifier: Apache-2.0
"""Commands go out on CAN: three frames together, or the command counts as failed."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import NamedTuple

from safety_island.can.bus import BusEvent, BusLink, Delivery, EventKind, MonotonicNs
from safety_island.can.command import Cause, ControlFields, as_published
from safety_island.can.counters import CanCounters
from safety_island.can.encoder import Rejection, Triple, encode
from safety_island.can.output_log import OutputLog
from safety_island.can.receiver import SEQUENCE_MODULUS
from safety_island.can.recovery import Recovery, Remedy
from safety_island.command.frames import FRAMES
from safety_island.command.mode import OutputMode
from safety_island.platform.interfaces import CanFrame, CanResult, Logger

FOREIGN_S = 1.0
"""After so long without a frame of another node nobody else commands the vehicle."""
Recorder = Callable[[int, Iterable[CanFrame]], None]
"""Told the stamp [ns] and the frames that were handed to the bus."""


class Sent(NamedTuple):
    """What became of one command."""

    sequence: int
    cause: Cause | None
    """None: all three frames were handed over."""


class CanOutput:
    """Sends commands over one bus; every failure is counted, told once, and recovered from.

    ``link``: the bus; None in a mode without CAN, or where the target has no bus and DDS goes on
    alone. ``budget_s``: the longest that one command may wait for the bus, at most a tenth of the
    control period. ``clock``: monotonic [ns], for the back-off. ``open_failure``: why the bus is
    not open yet; it is tried again.
    """

    name = "CAN"

    def __init__(
        self,
        mode: OutputMode,
        link: BusLink | None,
        budget_s: float,
        clock: MonotonicNs,
        logger: Logger,
        recorder: Recorder | None = None,
        open_failure: str | None = None,
    ) -> None:
        self.mode = mode
        self.counters = CanCounters()
        self.failed = 0
        """Commands that did not go out, rejected ones among them."""
        self.last: Sent | None = None
        """What became of the last command; None before the first."""
        self._link = link
        self._budget_s = budget_s
        self._clock = clock
        self._recorder = recorder
        self._sequence = 0
        self._is_renewed = self._has_polled = False
        self._foreign_frames, self._foreign_until_s = 0, -math.inf
        self._recovery = Recovery()
        self._log = OutputLog(logger)
        if open_failure is not None:
            self._recovery.fail(CanResult.NOT_OPEN, clock() / 1e9)
            self._log.not_open(open_failure)

    def send(self, command: ControlFields, stamp_ns: int) -> bool:
        """Send one command, stamped [ns]; True only when all three frames were handed over.

        Never raises. Each call uses up a sequence number, also for a rejected command. Without CAN
        (``DDS_ONLY``, or no bus) it does nothing.
        """
        if self._link is None or not self.mode.uses_can:
            return False
        sequence = self._sequence
        self._sequence = (sequence + 1) % SEQUENCE_MODULUS
        frames = encode(as_published(command), self.mode, sequence, stamp_ns)
        if isinstance(frames, Rejection):
            cause: Cause | None = self._reject(frames)
        else:
            cause = self._send_frames(self._link, frames, stamp_ns)
        self.failed += cause is not None
        self.last = Sent(sequence, cause)
        return cause is None

    def _send_frames(self, link: BusLink, frames: Triple, stamp_ns: int) -> Cause | None:
        now_s = self._clock() / 1e9
        delivery = self._deliver(link, frames, now_s)
        if delivery is None:
            return self._fail(0, self._recovery.last)
        if self._recorder is not None and delivery.sent:
            self._recorder(stamp_ns, frames[: delivery.sent])
        return self._judge(delivery, now_s)

    def listen(self) -> int:
        """Count our frames that another node sends; 0 when none came for a second.

        To be called in every tick. A command that was sent since has read the bus already.
        """
        now_s = self._clock() / 1e9
        if self._link is not None and not self._has_polled:
            self._take(self._link.poll(), now_s)
        self._has_polled = False
        if now_s >= self._foreign_until_s:
            self._foreign_frames = 0
            self._log.nothing_foreign()
        return self._foreign_frames

    def close(self) -> None:
        """Give the bus back; what waits behind a bus in trouble does not leave any more."""
        if self._link is None:
            return
        if self._recovery.failures:
            self._link.discard()
        self._link.close()

    def _reject(self, rejection: Rejection) -> Cause:
        self.counters.rejected += 1
        self.counters.frames[rejection.arbitration_id, rejection.cause] += 1
        self._log.rejected(rejection)
        return rejection.cause

    def _deliver(self, link: BusLink, frames: Triple, now_s: float) -> Delivery | None:
        """Hand the frames to the bus; None while it is not to be tried."""
        if link.is_opening:
            return None
        if not self._is_renewed and not self._mend(link, now_s):
            return None
        self._is_renewed = False
        self._has_polled = True
        return link.send(frames, self._budget_s)

    def _mend(self, link: BusLink, now_s: float) -> bool:
        """Do what the last failure asks for; return whether the bus may be tried at once."""
        match self._recovery.remedy(now_s):
            case Remedy.WAIT:
                return False
            case Remedy.DISCARD:
                link.discard()
            case Remedy.REOPEN:
                self.counters.reopened += 1
                link.reopen()
                self._is_renewed = link.is_opening
        return not self._is_renewed

    def _judge(self, delivery: Delivery, now_s: float) -> Cause | None:
        self._take(delivery.events, now_s)
        if delivery.result is CanResult.SENT:
            self.counters.sent += 1
            self._log.sent()
            self._recovery.succeed()
            return None
        self._recovery.fail(delivery.result, now_s)
        return self._fail(delivery.sent, delivery.result)

    def _take(self, events: Iterable[BusEvent], now_s: float) -> None:
        for event in events:
            self.counters.events[event.kind] += 1
            self._log.event(event)
            if event.kind is EventKind.FOREIGN_COMMAND:
                self._foreign_frames += 1
                self._foreign_until_s = now_s + FOREIGN_S

    def _fail(self, index: int, result: CanResult) -> Cause:
        cause = Cause[result.name]
        arbitration_id = FRAMES[index].arbitration_id
        self.counters.failed += 1
        self.counters.frames[arbitration_id, cause] += 1
        self._log.failed(arbitration_id, cause)
        return cause
