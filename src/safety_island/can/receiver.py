# SPDX-License-Identifier: Apache-2.0
"""The receiver's side: which commands of a bus may be acted on, and when there are none."""

from __future__ import annotations

from collections import Counter
from enum import StrEnum

from safety_island.can.decoder import Decoded, Fault
from safety_island.can.triple import Progress, TripleAssembler
from safety_island.platform.interfaces import CanFrame

LOST_PERIODS = 3
MAX_ADVANCE = LOST_PERIODS + 1
SEQUENCE_MODULUS = 1 << 16


def sequence_advance(newer: int, older: int) -> int:
    """Return how far a sequence number went on, modulo 65536."""
    return (newer - older) % SEQUENCE_MODULUS


class Verdict(StrEnum):
    """What became of a complete triple."""

    ACCEPTED = "accepted"
    FIRST = "first"
    """After the start or a loss: it is what the next one must advance from."""
    NOT_ADVANCED = "not_advanced"
    """Its sequence number repeats, goes back, or leaps: replayed, stale or corrupted."""


class Link(StrEnum):
    """Whether commands come in."""

    WAITING = "waiting"
    ALIVE = "alive"
    LOST = "lost"


class CommandReceiver:
    """Accepts a command when its triple is complete and its sequence number advances.

    Times are on one monotonic clock of the receiver [s]; ``period_s`` is the control period of the
    sender. Three periods without an accepted command are a loss. After it, as at the start, the
    sequence may begin anywhere, but it takes two triples in a row that advance: a single frame that
    a queue held back is never acted on. An accepted advance is 1 to 4.

    Not detectable, because no frame carries a checksum of its own: a corrupted value that passed
    the CRC of the CAN controller.
    """

    def __init__(self, period_s: float, window_s: float | None = None) -> None:
        self.period_s = period_s
        self.command: Decoded | None = None
        """The newest accepted command; ask ``link`` before acting on it."""
        self.counts: Counter[Verdict | Fault | Progress] = Counter()
        self._assembler = TripleAssembler(period_s / 2 if window_s is None else window_s)
        self._accepted_s: float | None = None
        self._baseline: tuple[int, float] | None = None

    def link(self, now_s: float) -> Link:
        """Tell whether commands come in."""
        if self._accepted_s is None:
            return Link.WAITING
        return Link.ALIVE if self._is_recent(self._accepted_s, now_s) else Link.LOST

    def feed(self, frame: CanFrame, now_s: float) -> Verdict | Fault | Progress:
        """Take a frame received at ``now_s``; ``Verdict.ACCEPTED`` means a new ``command``."""
        outcome = self._assembler.feed(frame, now_s)
        result = self._judge(outcome, now_s) if isinstance(outcome, Decoded) else outcome
        self.counts[result] += 1
        return result

    def _judge(self, decoded: Decoded, now_s: float) -> Verdict:
        known = self._baseline
        if known is None or not self._is_recent(known[1], now_s):
            self._baseline = (decoded.sequence, now_s)
            return Verdict.FIRST
        if not 1 <= sequence_advance(decoded.sequence, known[0]) <= MAX_ADVANCE:
            return Verdict.NOT_ADVANCED
        self._baseline = (decoded.sequence, now_s)
        self._accepted_s = now_s
        self.command = decoded
        return Verdict.ACCEPTED

    def _is_recent(self, time_s: float, now_s: float) -> bool:
        return now_s - time_s <= LOST_PERIODS * self.period_s
