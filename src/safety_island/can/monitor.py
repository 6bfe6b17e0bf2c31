"""What a bus or a log shows: rates, sequence gaps, ages, and the newest command."""

from __future__ import annotations

from collections import Counter, deque
from typing import NamedTuple

from safety_island.can.candump import LogEntry
from safety_island.can.decoder import Decoded, Fault
from safety_island.can.frames import FRAMES
from safety_island.can.receiver import LOST_PERIODS, SEQUENCE_MODULUS, sequence_advance
from safety_island.can.triple import Progress, TripleAssembler

TIMESTAMP_MODULUS = 1 << 32
RECENT = 64
"""Arrivals that a rate is taken from on a live bus."""


class Arrivals:
    """Times of one kind of thing: count, rate, longest gap, age."""

    def __init__(self, recent: int | None) -> None:
        self.count = 0
        self.longest_gap_s = 0.0
        self._times: deque[float] = deque(maxlen=recent)
        self._first_s = self._last_s = 0.0
        self._is_recent_only = recent is not None

    def add(self, time_s: float) -> float | None:
        """Note an arrival; return the gap before it, None for the first."""
        gap_s = time_s - self._last_s if self.count else None
        if gap_s is None:
            self._first_s = time_s
        else:
            self.longest_gap_s = max(self.longest_gap_s, gap_s)
        self.count += 1
        self._last_s = time_s
        if self._is_recent_only:
            self._times.append(time_s)
        return gap_s

    @property
    def rate_hz(self) -> float | None:
        """Mean rate, None before two arrivals at different times."""
        first = self._times[0] if self._is_recent_only and self._times else self._first_s
        gaps = (len(self._times) if self._is_recent_only else self.count) - 1
        span_s = self._last_s - first
        return gaps / span_s if span_s > 0.0 else None

    def age_s(self, now_s: float) -> float | None:
        """Time since the last arrival, None before the first."""
        return now_s - self._last_s if self.count else None


class Sequence:
    """Follows the sequence number over all complete commands."""

    def __init__(self) -> None:
        self.gaps = 0
        self.missing = 0
        self.repeated = 0
        self.backward = 0
        self._last: int | None = None

    def add(self, sequence: int) -> None:
        """Note the number of the next command."""
        if self._last is not None:
            self._count(sequence_advance(sequence, self._last))
        self._last = sequence

    def _count(self, advance: int) -> None:
        if advance == 0:
            self.repeated += 1
        elif advance >= SEQUENCE_MODULUS // 2:
            self.backward += 1
        elif advance > 1:
            self.gaps += 1
            self.missing += advance - 1


class Seen(NamedTuple):
    """One complete command and when its last frame came [s]."""

    time_s: float
    decoded: Decoded

    @property
    def lag_ms(self) -> int:
        """How much older its stamp is than its arrival; negative when the clocks disagree."""
        lag = (int(self.time_s * 1000) - self.decoded.timestamp_ms) % TIMESTAMP_MODULUS
        return lag - TIMESTAMP_MODULUS if lag >= TIMESTAMP_MODULUS // 2 else lag


class BusMonitor:
    """Takes the entries of a bus or a log in order; times are on one clock [s].

    ``period_s``: the control period of the island, which says how far apart the frames of one
    command may lie and when commands are lost. ``recent``: the rates come from so many arrivals;
    None: from all.
    """

    def __init__(self, period_s: float, recent: int | None = None) -> None:
        self.frames = {row.arbitration_id: Arrivals(recent) for row in FRAMES}
        self.commands = Arrivals(recent)
        self.sequence = Sequence()
        self.latest: Seen | None = None
        self.faults: Counter[Fault | Progress] = Counter()
        self.losses = 0
        self.other_frames = 0
        self.error_frames = 0
        self._lost_s = LOST_PERIODS * period_s
        self._assembler = TripleAssembler(period_s / 2)

    def feed(self, entry: LogEntry) -> Seen | None:
        """Take the next entry; return the command that it completes, if it does."""
        if entry.frame is None:
            self.error_frames += entry.is_error
            self.other_frames += not entry.is_error
            return None
        outcome = self._assembler.feed(entry.frame, entry.time_s)
        if outcome is Progress.UNRELATED:
            self.other_frames += 1
            return None
        self.frames[entry.frame.arbitration_id].add(entry.time_s)
        if isinstance(outcome, Decoded):
            return self._complete(Seen(entry.time_s, outcome))
        if outcome is not Progress.PENDING:
            self.faults[outcome] += 1
        return None

    def _complete(self, seen: Seen) -> Seen:
        gap_s = self.commands.add(seen.time_s)
        self.losses += gap_s is not None and gap_s > self._lost_s
        self.sequence.add(seen.decoded.sequence)
        self.latest = seen
        return seen
