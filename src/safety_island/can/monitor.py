# SPDX-License-Identifier: Apache-2.0
"""What a bus or a log shows: rates, sequence gaps, ages, losses, and the newest command."""

from __future__ import annotations

from collections import Counter, deque
from statistics import median
from typing import NamedTuple

from safety_island.can.candump import LogEntry
from safety_island.can.decoder import Decoded, Fault
from safety_island.can.receiver import LOST_PERIODS, SEQUENCE_MODULUS, Link, sequence_advance
from safety_island.can.triple import Progress, TripleAssembler
from safety_island.command.frames import FRAMES

TIMESTAMP_MODULUS = 1 << 32
RECENT = 64
"""Arrivals that a rate is taken from on a live bus."""
USUAL_PERIOD_S = 0.15
"""Of an island, until its frames show another."""
_GAPS = 15
_LONGEST_PERIOD_S = 1.0


class Arrivals:
    """Times of one kind of thing: count, rate, longest gap, age.

    An arrival has two times: that of the driver or the log, which gaps and rates are taken from,
    and that of the clock that ages are asked for with. In a log they are the same.
    """

    def __init__(self, recent: int | None) -> None:
        self.count = 0
        self.longest_gap_s = 0.0
        self._times: deque[float] = deque(maxlen=recent)
        self._first_s = self._last_s = self._heard_s = 0.0
        self._is_recent_only = recent is not None

    def add(self, time_s: float, heard_s: float) -> float | None:
        """Note an arrival; return the gap before it, None for the first.

        The gap is the smaller one of both clocks: a driver's clock may be set, and a monitor that
        was stalled reads late what came in time.
        """
        gap_s = None
        if self.count:
            gap_s = min(time_s - self._last_s, heard_s - self._heard_s)
            self.longest_gap_s = max(self.longest_gap_s, gap_s)
        else:
            self._first_s = time_s
        self.count += 1
        self._last_s, self._heard_s = time_s, heard_s
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
        return now_s - self._heard_s if self.count else None


class Sequence:
    """Follows the sequence number over all complete commands."""

    def __init__(self) -> None:
        self.gaps = 0
        self.missing = 0
        self.repeated = 0
        self.backward = 0
        self._last: int | None = None

    def add(self, sequence: int) -> bool:
        """Note the number of the next command; whether it goes on, as the first one does."""
        advance = 1 if self._last is None else sequence_advance(sequence, self._last)
        self._last = sequence
        if advance == 0:
            self.repeated += 1
        elif advance >= SEQUENCE_MODULUS // 2:
            self.backward += 1
        elif advance > 1:
            self.gaps += 1
            self.missing += advance - 1
        return 1 <= advance < SEQUENCE_MODULUS // 2


class Seen(NamedTuple):
    """One complete command and when its last frame came [s]."""

    time_s: float
    decoded: Decoded

    @property
    def lag_ms(self) -> int:
        """How much older its stamp is than its arrival; negative when the clocks disagree."""
        lag = (int(self.time_s * 1000) - self.decoded.timestamp_ms) % TIMESTAMP_MODULUS
        return lag - TIMESTAMP_MODULUS if lag >= TIMESTAMP_MODULUS // 2 else lag


class Losses:
    """Times without a command that goes on in its sequence: a receiver acts on no other.

    ``limit_s`` is three periods. A loss that lasts counts as soon as it is one; so does waiting
    for a first command, until it comes.
    """

    def __init__(self, period_s: float | None) -> None:
        self.over = 0
        """Losses that have ended."""
        self._period_s = period_s
        self._gaps: deque[float] = deque(maxlen=_GAPS)
        self._since_s: float | None = None
        self._has_begun = False

    @property
    def period_s(self) -> float:
        """The control period: as given, else as the frames of one kind follow each other."""
        if self._period_s is not None:
            return self._period_s
        return min(median(self._gaps), _LONGEST_PERIOD_S) if self._gaps else USUAL_PERIOD_S

    @property
    def limit_s(self) -> float:
        """Time without a command from which on it is a loss."""
        return LOST_PERIODS * self.period_s

    def start(self, now_s: float) -> None:
        """Begin to wait, if that has not begun."""
        if self._since_s is None:
            self._since_s = now_s

    def frame(self, gap_s: float | None) -> None:
        """Note the gap between two frames with the same identifier."""
        if gap_s is not None and gap_s > 0.0:
            self._gaps.append(gap_s)

    def command(self, gap_s: float | None, now_s: float) -> None:
        """Note a command that goes on, so long after the one before."""
        self.over += gap_s is not None and gap_s > self.limit_s
        self._since_s, self._has_begun = now_s, True

    def age_s(self, now_s: float) -> float:
        """Time since the last such command, or since the monitor waits for one."""
        return 0.0 if self._since_s is None else now_s - self._since_s

    def link(self, now_s: float) -> Link:
        """Tell whether commands come in."""
        if self.age_s(now_s) > self.limit_s:
            return Link.LOST
        return Link.ALIVE if self._has_begun else Link.WAITING

    def count(self, now_s: float) -> int:
        """Count losses, one that goes on at ``now_s`` among them."""
        return self.over + (self.link(now_s) is Link.LOST)


class BusMonitor:
    """Takes the entries of a bus or a log in order; times are on one clock [s].

    ``period_s``: the control period of the island; None: as its frames show. ``recent``: the rates
    come from so many arrivals; None: from all. ``started_s``: when it began to listen; None: with
    the first entry.
    """

    def __init__(
        self,
        period_s: float | None = None,
        recent: int | None = None,
        started_s: float | None = None,
    ) -> None:
        self.frames = {row.arbitration_id: Arrivals(recent) for row in FRAMES}
        self.commands = Arrivals(recent)
        self.sequence = Sequence()
        self.losses = Losses(period_s)
        self.latest: Seen | None = None
        self.faults: Counter[Fault | Progress] = Counter()
        self.other_frames = 0
        self.error_frames = 0
        self._fresh = Arrivals(recent)
        self._assembler = TripleAssembler((period_s or USUAL_PERIOD_S) / 2)
        if started_s is not None:
            self.losses.start(started_s)

    def feed(self, entry: LogEntry, heard_s: float | None = None) -> Seen | None:
        """Take the next entry; return the command that it completes, if it does.

        ``heard_s``: when it was read on the clock of ``started_s``; None: as the entry says.
        """
        now_s = entry.time_s if heard_s is None else heard_s
        self.losses.start(now_s)
        if entry.frame is None:
            self.error_frames += entry.is_error
            self.other_frames += not entry.is_error
            return None
        outcome = self._assembler.feed(entry.frame, entry.time_s)
        if outcome is Progress.UNRELATED:
            self.other_frames += 1
            return None
        self.losses.frame(self.frames[entry.frame.arbitration_id].add(entry.time_s, now_s))
        self._assembler.window_s = self.losses.period_s / 2
        if isinstance(outcome, Decoded):
            return self._complete(Seen(entry.time_s, outcome), now_s)
        if outcome is not Progress.PENDING:
            self.faults[outcome] += 1
        return None

    def _complete(self, seen: Seen, now_s: float) -> Seen:
        self.commands.add(seen.time_s, now_s)
        if self.sequence.add(seen.decoded.sequence):
            self.losses.command(self._fresh.add(seen.time_s, now_s), now_s)
        self.latest = seen
        return seen

    def alarm(self, now_s: float) -> str:
        """Say what a loss that goes on looks like; empty when there is none."""
        if self.losses.link(now_s) is not Link.LOST:
            return ""
        begun = "no command has come" if self.latest is None else "no new command"
        return f"LOST: {begun} for {self.losses.age_s(now_s):.3f} s{self._cause(now_s)}"

    def _cause(self, now_s: float) -> str:
        """What still comes, and what does not."""
        ages = {i: arrivals.age_s(now_s) for i, arrivals in self.frames.items()}
        limit_s = self.losses.limit_s
        absent = [i for i, age_s in ages.items() if age_s is None or age_s > limit_s]
        if len(absent) == len(ages):
            return ", and none of its frames comes"
        if absent:
            return f", {' and '.join(f'0x{i:03X}' for i in absent)} missing"
        age_s = self.commands.age_s(now_s)
        if age_s is not None and age_s <= limit_s and self.latest is not None:
            return f", the sequence does not advance from {self.latest.decoded.sequence}"
        return ", its frames do not make a command"
