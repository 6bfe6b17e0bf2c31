# SPDX-License-Identifier: Apache-2.0
"""What is sent on change: no old word comes back into force, and no STOP is lost."""

from __future__ import annotations

import math
from typing import NamedTuple

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safety_island.input_gate.latched import OVERTAKEN_S, REMEMBERED, WRITERS, LatchedGate
from safety_island.input_gate.reason import SampleReason
from safety_island.input_gate.sender_clock import SenderClock
from safety_island.kernel.cdr import CDR_LE
from safety_island.messages.wire import Time
from tests.input_gate.clock.other import Input

DUPLICATE, OLDER = SampleReason.DUPLICATE, SampleReason.OLDER
A, B = b"a" * 16, b"b" * 16
S = 10**9


class Word(NamedTuple):
    """A mode as one writer said it: its stamp and source time [s]."""

    says: str
    stamp_s: float
    source_s: float
    writer_guid: bytes = A

    @property
    def time(self) -> Time:
        return Time.from_seconds(self.stamp_s)

    @property
    def data(self) -> bytes:
        sec, nanosec = self.time
        head = CDR_LE + bytes(2) + sec.to_bytes(4, "little", signed=True)
        return head + nanosec.to_bytes(4, "little") + self.says.encode()

    @property
    def source_timestamp_ns(self) -> int:
        return round(self.source_s * S)


def auto(at: float, source: float | None = None, writer: bytes = A) -> Word:
    return Word("AUTO", at, at if source is None else source, writer)


def stop(at: float, source: float | None = None, writer: bytes = A) -> Word:
    return Word("STOP", at, at if source is None else source, writer)


class Island:
    """A gate, what is in force, and a sender whose other inputs show a time."""

    def __init__(self) -> None:
        self.sender = SenderClock()
        self.gate = LatchedGate(self.sender)
        self.now = 1000.0
        self.in_force: Word | None = None
        self.unusual = 0
        self.gate.on_unusual = self._note
        self._other = Input(self.sender, limit_s=1e6)
        self.shows(None)

    def _note(self) -> None:
        self.unusual += 1

    def shows(self, clock_s: float | None) -> None:
        """What the other inputs' stamps say now [s], None when none is heard."""
        self._other.heard = clock_s is not None
        self._other.held_ns = round((clock_s or 0.0) * S)

    def tick(self, *words: Word) -> list[SampleReason]:
        """Receive words in one tick; what they were refused for."""
        self.now += 0.15
        reasons = []
        for word in self.gate.newest_first(words):
            reason = self.gate.judge(word.time, word, self.now, word.says == "AUTO")
            if reason is None:
                self.gate.hold(word.data, self.now)
                self.in_force = word
                break
            reasons.append(reason)
        self.gate.remember(words)
        return reasons


@pytest.fixture
def island() -> Island:
    """AUTONOMOUS was said, then STOP."""
    island = Island()
    for word in (auto(1.0), stop(2.0)):
        assert island.tick(word) == []
    return island


def test_the_numbers() -> None:
    assert (REMEMBERED, WRITERS, OVERTAKEN_S) == (256, 16, 1.0)
    gate = LatchedGate(SenderClock())
    assert (gate.delay_s, gate.limit_s, gate.usual_delay_s) == (0.0, math.inf, math.inf)
    assert (gate.steps_back, gate.step_told_until) == (0, -math.inf)
    gate.fade()
    gate.on_unusual()


class TestHistoryDeliveredAgain:
    """After a match that was lost and renewed, oldest first, in one tick or over several."""

    def test_at_once(self, island: Island) -> None:
        assert island.tick(auto(1.0), stop(2.0)) == [DUPLICATE]
        assert island.in_force == stop(2.0)

    def test_over_several_ticks(self, island: Island) -> None:
        assert [island.tick(word) for word in (auto(1.0), stop(2.0))] == [[DUPLICATE]] * 2
        assert island.in_force == stop(2.0)

    def test_written_anew_by_a_bridge(self, island: Island) -> None:
        """Its source time goes on, its stamp does not."""
        assert island.tick(auto(1.0, source=3.0)) == [DUPLICATE]

    def test_with_what_was_said_meanwhile(self, island: Island) -> None:
        assert island.tick(auto(1.0), stop(2.0), auto(3.0)) == []
        assert island.in_force == auto(3.0)

    def test_with_what_was_never_received(self, island: Island) -> None:
        """A STOP that is older ends autonomy all the same, an AUTONOMOUS gives none."""
        assert island.tick(auto(1.5)) == [OLDER]
        assert island.tick(stop(1.6)) == []

    def test_what_was_passed_over_in_its_tick_is_known_as_well(self) -> None:
        island = Island()
        island.tick(auto(1.0), stop(2.0))
        assert island.tick(auto(1.0)) == [DUPLICATE]

    def test_what_was_refused_stays_so(self, island: Island) -> None:
        island.tick(auto(1.5))
        island.shows(1.6)
        assert island.tick(auto(1.5)) == [DUPLICATE]

    def test_after_more_than_can_be_remembered_the_stamp_tells(self, island: Island) -> None:
        for i in range(REMEMBERED):
            island.tick(stop(3.0 + i))
        assert island.tick(auto(1.0)) == [OLDER]

    def test_of_a_writer_that_comes_back_its_newest_counts(self, island: Island) -> None:
        assert island.tick(auto(0.5, writer=B)) == []
        assert island.tick(auto(1.0)) == [DUPLICATE]
        assert island.tick(stop(2.0)) == []
        assert island.in_force == stop(2.0)
        assert island.tick(stop(2.0)) == [DUPLICATE]


class TestOrder:
    def test_what_is_newer_is_accepted(self, island: Island) -> None:
        assert island.tick(auto(2.0 + 1e-9)) == []

    def test_so_is_another_word_of_the_same_time(self, island: Island) -> None:
        assert island.tick(auto(2.0)) == []
        assert island.tick(stop(2.0, source=2.0)) == [DUPLICATE]

    def test_what_was_written_before_is_old_whatever_its_stamp(self, island: Island) -> None:
        assert island.tick(auto(3.0, source=1.5)) == [OLDER]

    def test_a_stop_is_never_lost(self, island: Island) -> None:
        island.tick(auto(3.0))
        assert island.tick(stop(2.5, source=0.5)) == []
        assert island.gate.steps_back == 1

    def test_a_successor_may_have_another_clock(self, island: Island) -> None:
        assert island.tick(auto(0.25, writer=B)) == []
        assert island.gate.steps_back == 0

    def test_the_writers_of_long_ago_are_forgotten(self, island: Island) -> None:
        for i in range(WRITERS - 1):
            island.tick(stop(9.0, writer=bytes([i]) * 16))
        assert island.tick(auto(1.0)) == [DUPLICATE]
        island.tick(stop(9.0, writer=B))
        assert island.tick(auto(1.0)) == []

    def test_to_forget_is_to_know_nobody(self, island: Island) -> None:
        island.gate.forget()
        assert island.tick(auto(1.0)) == []

    @pytest.mark.parametrize("bad", [Time(0, 0), Time(-1, 5), Time(0, 2**32 - 1), Time(3, 10**9)])
    def test_what_is_no_time(self, island: Island, bad: Time) -> None:
        before = island.unusual
        reason = island.gate.judge(bad, stop(9.0), island.now, False)
        assert (reason, island.unusual) == (SampleReason.BAD_STAMP, before + 1)

    @pytest.mark.parametrize("good", [Time(0, 1), Time(1, 10**9 - 1)])
    def test_the_ends_of_what_is_a_time(self, good: Time) -> None:
        assert Island().gate.judge(good, stop(9.0), 0.0, False) is None


class TestClockOfTheSender:
    """It was set back: the stamps of the other inputs show it."""

    def test_an_engagement_after_a_step_back_counts(self, island: Island) -> None:
        island.shows(0.5)
        assert island.tick(auto(0.6)) == []
        assert island.gate.steps_back == 1
        assert island.gate.step_told_until == island.now + 1.0

    @pytest.mark.parametrize(
        ("shown_s", "stamp_s", "reasons"),
        [
            (0.9999, 0.9, []),
            (1.0, 0.9, [OLDER]),  # the newest word may be one of this second
            (0.6, 1.6, []),
            (0.6, 1.6001, [OLDER]),
            (0.5001, 0.0001, []),
            (None, 0.6, [OLDER]),
        ],
    )
    def test_it_must_lie_behind_the_newest_word_and_this_one_must_be_of_now(
        self, shown_s: float | None, stamp_s: float, reasons: list[SampleReason]
    ) -> None:
        island = Island()
        island.tick(stop(2.0))
        island.shows(shown_s)
        assert island.tick(auto(stamp_s, source=3.0)) == reasons

    def test_an_old_engagement_of_before_the_step_does_not(self, island: Island) -> None:
        island.tick(stop(100.0))
        island.shows(50.0)
        assert island.tick(auto(90.0)) == [OLDER]
        assert island.tick(auto(30.0)) == [OLDER]

    def test_the_clock_of_the_writer_alone_was_set_back(self, island: Island) -> None:
        """Stamps by simulation time, source times by a wall clock."""
        island.shows(3.0)
        assert island.tick(auto(3.0, source=1.0)) == []
        assert island.gate.steps_back == 0

    def test_a_step_ends_nothing_that_is_said_again(self, island: Island) -> None:
        island.shows(0.5)
        island.tick(auto(0.6))
        assert island.tick(stop(0.7)) == []
        assert island.tick(auto(0.8)) == []


class TestOneTick:
    def test_one_that_was_overtaken_does_not_count(self) -> None:
        island = Island()
        assert island.tick(stop(2.0), auto(1.5)) == []
        assert island.in_force == stop(2.0)

    def test_the_last_one_counts_where_the_clock_was_set(self) -> None:
        island = Island()
        island.tick(auto(100.0), stop(50.0))
        assert island.in_force == stop(50.0)

    @pytest.mark.parametrize(("stamp_s", "wins"), [(1.0, False), (0.9375, True)])
    def test_a_second_is_the_bound(self, stamp_s: float, wins: bool) -> None:
        island = Island()
        island.tick(auto(2.0), stop(stamp_s))
        assert (island.in_force == stop(stamp_s)) is wins

    def test_they_are_tried_from_the_newest_on(self) -> None:
        gate = LatchedGate(SenderClock())
        words = [auto(1.0), auto(1.5), stop(1.25), auto(1.125)]
        assert gate.newest_first(words) == [auto(1.5), stop(1.25), auto(1.125)]
        assert gate.newest_first(words[:1]) == words[:1]

    def test_what_cannot_be_read_comes_last(self) -> None:
        class Torn(Word):
            @property
            def data(self) -> bytes:
                return b"\0\1"

        torn = Torn("AUTO", 0.0, 9.0)
        gate = LatchedGate(SenderClock())
        assert gate.newest_first([auto(1.0), torn]) == [auto(1.0), torn]
        assert gate.newest_first([torn, auto(1.0)]) == [auto(1.0), torn]
        assert gate.newest_first([torn, auto(0.0)]) == [auto(0.0), torn]

    def test_of_what_is_known_the_last_one_is_looked_at(self, island: Island) -> None:
        assert island.gate.newest_first([auto(1.0), stop(2.0)]) == [stop(2.0)]


said = st.lists(st.tuples(st.booleans(), st.integers(1, 5)), min_size=1, max_size=20)
"""Words, each with the time since the one before it."""


@settings(deadline=None)
@given(said, st.lists(st.integers(0, 3), max_size=20), st.integers(0, 20), st.booleans())
def test_a_history_that_comes_again_in_any_portions_changes_nothing(
    words: list[tuple[bool, int]], portions: list[int], depth: int, is_bridged: bool
) -> None:
    island, at, history = Island(), 0, []
    for gives, since in words:
        at += since
        history.append(auto(float(at)) if gives else stop(float(at)))
        island.tick(history[-1])
    newest = island.in_force
    assert newest == history[-1]
    rest = history[-depth:] if depth else []
    for i, portion in enumerate([*portions, len(rest)]):
        part, rest = rest[:portion], rest[portion:]
        source = {"source_s": 1000.0 + i} if is_bridged else {}
        island.tick(*[word._replace(**source) for word in part])  # type: ignore[arg-type]
        assert island.in_force == newest
