# SPDX-License-Identifier: Apache-2.0
"""The order of what is sent on change and kept for late readers: the operation mode.

Nothing says it again, so no word may be lost, and no old word may come back into force. The rule:

1. What a writer has said once, byte for byte, it says again only when DDS (after a match that was
   lost and renewed) or a bridge delivers its history again: it changes nothing. One exception: the
   newest word of a writer comes into force again where another writer's is.
2. What is new by its stamp and by its source time is accepted, and so is the first word of a
   writer: a successor may have another clock.
3. What is older by either, and was never received, is an old word or that of a clock that was set
   back. One that takes autonomy away is accepted: to lose it is worse than to stop for nothing.
   One that gives autonomy is refused, unless the stamps of the other inputs show that it was said
   now, and its stamp is the higher one or the clock was set back behind the newest word.
4. Of what comes within one tick, an older word by no more than OVERTAKEN_S was overtaken on its
   way; where the stamps go back by more, a clock was set and the last to arrive is the newest.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Protocol, TypeVar

from safety_island.input_gate.clock.judge import STEP_TOLD_S
from safety_island.input_gate.newest import NO_STAMP, TRIES, read_stamp
from safety_island.input_gate.reason import SampleReason
from safety_island.input_gate.sender_clock import SenderClock
from safety_island.kernel.cdr import NANOSECONDS

REMEMBERED = 256
"""Words of a writer that are known again: more than any writer keeps of what is latched."""

WRITERS = 16
"""Writers whose words are remembered."""

OVERTAKEN_S = 1.0
"""Difference of two stamps [s] within one tick up to which one was overtaken by the other."""

NOW_NS = NANOSECONDS
"""Distance of a stamp [ns] from those of the other inputs within which it was made now."""


class Word(Protocol):
    """One received sample."""

    @property
    def data(self) -> bytes:
        """Serialized message that begins with a stamp."""

    @property
    def source_timestamp_ns(self) -> int:
        """When its writer wrote it, by the clock of that machine."""

    @property
    def writer_guid(self) -> bytes:
        """Its writer."""


W = TypeVar("W", bound=Word)


class _Said:
    """What one writer has said: all that is remembered, and the word accepted last."""

    def __init__(self) -> None:
        self.words: dict[bytes, None] = {}
        """In the order in which they were said."""
        self.newest = b""
        self.stamp_ns = self.source_ns = 0


class LatchedGate:
    """Checks the samples of a latched input; told the time [s, monotonic], reads no clock.

    ``judge`` says why a sample is refused, ``hold`` stores the judged one, and ``remember`` notes
    what a tick received, whatever became of it. ``sender``: the clock of the other inputs.
    """

    limit_s = usual_delay_s = math.inf
    delay_s = 0.0
    """It was stamped when it changed: its delay means nothing."""

    def __init__(self, sender: SenderClock) -> None:
        self.on_unusual: Callable[[], None] = lambda: None
        """Called for each sample that is refused, or whose stamp goes back."""
        self.steps_back = 0
        """Accepted samples that were older than the one before, of the same writer."""
        self.step_told_until = -math.inf
        """Time [s, monotonic] until which a step back is reported."""
        self.sender = sender
        self.forget()

    def forget(self) -> None:
        """Hold nothing and know no writer: the next sample is accepted whatever its stamp."""
        self._said: dict[bytes, _Said] = {}
        self._source = self._writer = b""
        self._stamp_ns = self._source_ns = 0

    def newest_first(self, samples: Sequence[W]) -> Sequence[W]:
        """Return at most TRIES samples in the order in which they are tried.

        ``samples`` are of one writer, in the order of arrival. What was said before comes last.
        """
        order: list[W] = []
        for sample in samples:
            if not self._is_known(sample):
                order.insert(_place(order, read_stamp(sample.data)), sample)
        return order[:TRIES] or samples[-1:]

    def judge(
        self, stamp: tuple[int, int], word: Word, now: float, gives: bool
    ) -> SampleReason | None:
        """Say why a sample is refused, None when it is good.

        ``gives``: it gives autonomy; any other one takes it away.
        """
        sec, nanosec = stamp
        self._stamp_ns = stamp_ns = sec * NANOSECONDS + nanosec
        self._source_ns = word.source_timestamp_ns
        self._writer = word.writer_guid
        said = self._said.get(word.writer_guid)
        if stamp_ns <= 0 or nanosec >= NANOSECONDS:
            reason: SampleReason | None = SampleReason.BAD_STAMP
        elif said is None:
            reason = None
        elif word.data in said.words:
            is_back = self._source != word.writer_guid and word.data == said.newest
            reason = None if is_back else SampleReason.DUPLICATE
        else:
            is_old = gives and self._is_older(said, word) and not self._is_said_now(said, now)
            reason = SampleReason.OLDER if is_old else None
        if reason is not None:
            self.on_unusual()
        return reason

    def hold(self, data: bytes, now: float) -> None:
        """Store the sample that was judged last."""
        said = self._said_by(self._writer)
        if self._source == self._writer and self._stamp_ns < said.stamp_ns:
            self.steps_back += 1
            self.step_told_until = now + STEP_TOLD_S
            self.on_unusual()
        said.newest, self._source = data, self._writer
        said.stamp_ns, said.source_ns = self._stamp_ns, self._source_ns

    def remember(self, samples: Sequence[Word]) -> None:
        """Note what was received, so that it is known when it comes again."""
        for sample in samples:
            if not self._is_known(sample):
                words = self._said_by(sample.writer_guid).words
                if len(words) >= REMEMBERED:
                    del words[next(iter(words))]
                words[sample.data] = None

    def fade(self) -> None:
        """Nothing of it fades."""

    def _is_known(self, sample: Word) -> bool:
        said = self._said.get(sample.writer_guid)
        return said is not None and sample.data in said.words

    def _said_by(self, guid: bytes) -> _Said:
        """Return what a writer has said; the writer that was new longest ago is forgotten."""
        if guid not in self._said:
            while len(self._said) >= WRITERS:
                del self._said[next(iter(self._said))]
            self._said[guid] = _Said()
        return self._said[guid]

    def _is_older(self, said: _Said, word: Word) -> bool:
        return self._stamp_ns < said.stamp_ns or word.source_timestamp_ns < said.source_ns

    def _is_said_now(self, said: _Said, now: float) -> bool:
        """Whether the stamps of the other inputs show that it was said now, after the newest.

        Then either its stamp is the higher one, or the clock was set back behind that one.
        """
        clock_ns = self.sender.stamp_ns(now)
        if clock_ns is None or abs(self._stamp_ns - clock_ns) > NOW_NS:
            return False
        return self._stamp_ns > said.stamp_ns or said.stamp_ns - clock_ns > NOW_NS


def _place(order: Sequence[Word], stamp: tuple[float, ...]) -> int:
    """Return where the next one to arrive belongs among those that are tried, newest first."""
    if stamp == NO_STAMP:
        return len(order)
    for place, other in enumerate(order):
        if not 0.0 < _seconds(read_stamp(other.data)) - _seconds(stamp) <= OVERTAKEN_S:
            return place
    return len(order)


def _seconds(stamp: tuple[float, ...]) -> float:
    return math.fsum((stamp[0], stamp[-1] / NANOSECONDS)) if stamp != NO_STAMP else -math.inf
