# SPDX-License-Identifier: Apache-2.0
"""Stamps one by one, each limit at its boundary. 1 tick = 1/8 s, the age limit 1/2 s."""

from __future__ import annotations

import math

import pytest

from safety_island.input_gate.clock.judge import (
    BEGIN_ANEW_S,
    FORGET_RATE,
    STEP_TOLD_S,
    USUAL_DELAY_SHARE,
)
from safety_island.input_gate.clock.search import SEARCH_SHARE
from safety_island.input_gate.clock.sender import fallen
from safety_island.input_gate.reason import SampleReason
from safety_island.input_gate.sender_clock import SenderClock
from safety_island.input_gate.stamps import StampGate
from safety_island.messages.wire import Time

OLDER, DELAYED = SampleReason.OLDER, SampleReason.DELAYED


def stamp(seconds: float) -> Time:
    return Time.from_seconds(seconds)


def fallen_s(gate: StampGate) -> float:
    """How far the held stamp has fallen behind [s]."""
    return float(fallen(gate.state[0]))


def offer(
    gate: StampGate, seconds: float, now: float, data: bytes | None = None
) -> SampleReason | None:
    """Judge a sample, and hold it when it is good."""
    data = repr((seconds, now)).encode() if data is None else data
    reason = gate.judge(stamp(seconds), data, now)
    if reason is None:
        gate.hold(data, now)
    return reason


@pytest.fixture
def gate() -> StampGate:
    """Holds a sample of stamp 100 s that came at 1000 s."""
    gate = StampGate(0.5)
    assert offer(gate, 100.0, 1000.0, b"said before.held") is None
    return gate


def test_the_numbers() -> None:
    assert (BEGIN_ANEW_S, FORGET_RATE, SEARCH_SHARE, STEP_TOLD_S) == (10.0, 0.001, 0.5, 1.0)
    assert (StampGate().limit_s, StampGate().usual_delay_s) == (math.inf, math.inf)
    assert (USUAL_DELAY_SHARE, StampGate(0.5).usual_delay_s) == (0.5, 0.25)
    assert (StampGate(0.5).steps_back, StampGate(0.5).delay_s, StampGate(0.5).stamp_ns) == (0, 0, 0)
    assert StampGate(0.5).step_told_until == -math.inf


@pytest.mark.parametrize(
    "bad", [Time(0, 0), Time(-1, 0), Time(-1, 5), Time(1, 10**9), Time(0, 2**32 - 1)]
)
def test_what_is_no_time(bad: Time) -> None:
    assert StampGate(0.5).judge(bad, b"", 0.0) is SampleReason.BAD_STAMP


@pytest.mark.parametrize("nanosec", [10**9, 10**9 + 1])
def test_what_is_no_time_though_it_would_fit(gate: StampGate, nanosec: int) -> None:
    """The sender's clock had a second more; the stamp is as far as the time."""
    assert gate.judge(Time(100, nanosec), b"", 1001.0) is SampleReason.BAD_STAMP
    assert gate.judge(Time(101, 0), b"", 1001.0) is None


@pytest.mark.parametrize("good", [Time(0, 1), Time(1, 0), Time(1, 10**9 - 1), Time(2**31 - 1, 0)])
def test_the_ends_of_what_is_a_time(good: Time) -> None:
    gate = StampGate(0.5)
    assert gate.judge(good, b"", 0.0) is None
    assert gate.stamp_ns == good.nanoseconds


def test_the_same_bytes_again(gate: StampGate) -> None:
    assert offer(gate, 100.0, 1000.125, b"said before.held") is SampleReason.DUPLICATE
    assert offer(gate, 100.0, 1000.125, b"other") is SampleReason.STAMP_STANDS_STILL


def test_a_stamp_that_stands_still_never_refreshes(gate: StampGate) -> None:
    for seconds in (0.125, 9.0, 11.0, 1e6):
        assert offer(gate, 100.0, 1000.0 + seconds) is SampleReason.STAMP_STANDS_STILL


def test_after_ten_seconds_it_begins_anew_and_not_before(gate: StampGate) -> None:
    """What came last is too old by then to say what is late."""
    assert offer(gate, 100.25, 1000.0 + BEGIN_ANEW_S) is DELAYED
    assert offer(gate, 100.25, 1000.001 + BEGIN_ANEW_S) is None


def test_what_it_says_after_its_stamp(gate: StampGate) -> None:
    assert gate.repeats(b"other header" + b"held")
    assert not gate.repeats(b"said before.help")
    assert not gate.repeats(b"said before.Held")
    assert not gate.repeats(b"said before.held!")
    gate.forget()
    assert not gate.repeats(b"said before.held")
    assert not StampGate(0.5).repeats(b"other header" + b"held")


class TestDelay:
    @pytest.mark.parametrize(("late_s", "reason"), [(0.499, None), (0.502, DELAYED)])
    def test_one_sample_that_took_longer(
        self, gate: StampGate, late_s: float, reason: SampleReason | None
    ) -> None:
        assert offer(gate, 100.125, 1000.125 + late_s) is reason

    def test_the_limit_itself_is_not_beyond(self) -> None:
        gate = StampGate(0.5 * (1.0 - FORGET_RATE) - 0.125)
        offer(gate, 100.0, 1000.0)
        assert offer(gate, 100.125, 1000.5) is None
        assert gate.delay_s == 0.5 * (1.0 - FORGET_RATE) - 0.125

    def test_the_smallest_step_of_a_stamp(self, gate: StampGate) -> None:
        assert gate.judge(Time(100, 1), b"", 1000.25) is None
        gate.hold(b"", 1000.25)
        assert gate.delay_s == pytest.approx(0.25 - 0.00025)

    def test_after_the_longest_pause(self, gate: StampGate) -> None:
        assert offer(gate, 109.75, 1010.0) is None
        assert gate.delay_s == pytest.approx(0.25 - 0.01)

    def test_delay_adds_up_over_samples(self, gate: StampGate) -> None:
        found = [offer(gate, 100.0 + 0.0625 * i, 1000.0 + 0.125 * i) for i in range(1, 10)]
        assert found == [None] * 8 + [DELAYED]
        assert gate.delay_s == pytest.approx(8 * (0.0625 - 0.000125))

    def test_what_is_refused_adds_nothing(self, gate: StampGate) -> None:
        for _ in range(5):
            assert offer(gate, 100.125, 1002.0) is DELAYED
        assert gate.delay_s == 0.0
        assert offer(gate, 102.0, 1002.125) is None
        assert gate.delay_s == pytest.approx(0.125 - 0.002125)

    def test_a_quicker_sample_takes_it_back_and_no_further(self, gate: StampGate) -> None:
        offer(gate, 100.125, 1000.375)
        assert gate.delay_s == pytest.approx(0.25 - 0.000375)
        offer(gate, 100.5, 1000.5)
        assert gate.delay_s == 0.0
        offer(gate, 100.625, 1000.875)
        assert gate.delay_s == pytest.approx(0.25 - 0.000375)


class TestOlder:
    def test_a_sample_that_was_overtaken(self, gate: StampGate) -> None:
        assert offer(gate, 99.9, 1000.125) is OLDER
        assert offer(gate, 100.125, 1000.125) is None

    def test_a_clock_that_was_set_back_shows_after_half_the_limit(self, gate: StampGate) -> None:
        found = [offer(gate, 50.0 + 0.125 * i, 1000.125 + 0.125 * i) for i in range(3)]
        assert found == [OLDER, OLDER, None]
        assert gate.steps_back == 1
        assert offer(gate, 50.375, 1000.5) is None
        assert gate.steps_back == 1

    def test_it_may_have_come_to_the_held_stamp_by_then(self, gate: StampGate) -> None:
        found = [offer(gate, 99.75 + 0.125 * i, 1000.125 + 0.125 * i) for i in range(3)]
        assert found == [OLDER, OLDER, None]
        assert (gate.steps_back, gate.delay_s) == (1, 0.0)

    def test_just_before_it_does_not(self, gate: StampGate) -> None:
        assert offer(gate, 50.0, 1000.125) is OLDER
        assert offer(gate, 50.25, 1000.3749) is OLDER
        assert gate.steps_back == 0

    @pytest.mark.parametrize("second", [50.0, 49.0])
    def test_older_stamps_that_do_not_advance_begin_the_search_anew(
        self, gate: StampGate, second: float
    ) -> None:
        assert offer(gate, 50.0, 1000.125) is OLDER
        assert offer(gate, second, 1000.375) is OLDER
        assert offer(gate, 50.5, 1000.5) is OLDER
        assert offer(gate, 50.625, 1000.625) is None

    def test_a_gap_beyond_the_limit_begins_the_search_anew(self, gate: StampGate) -> None:
        """One that was overtaken, and much later another one: no clock."""
        assert offer(gate, 50.0, 1000.125) is OLDER
        assert offer(gate, 50.5, 1000.6251) is OLDER
        assert offer(gate, 51.0, 1001.1251) is None

    def test_a_good_sample_ends_the_search(self, gate: StampGate) -> None:
        assert offer(gate, 50.0, 1000.125) is OLDER
        assert offer(gate, 100.25, 1000.25) is None
        assert offer(gate, 50.25, 1000.375) is OLDER
        assert offer(gate, 50.5, 1000.5) is OLDER

    def test_several_samples_in_one_tick(self, gate: StampGate) -> None:
        for tick in range(3):
            now = 1000.125 + 0.125 * tick
            newest = offer(gate, 50.0 + 0.125 * tick, now)
            assert newest is (OLDER if tick < 2 else None)
            if newest is OLDER:  # the tick looks at those before it, too
                assert offer(gate, 49.95 + 0.125 * tick, now) is OLDER
        assert gate.steps_back == 1

    def test_what_was_set_back_once_is_not_set_back_again_in_the_same_tick(
        self, gate: StampGate
    ) -> None:
        found = [offer(gate, 50.0 + 0.25 * i, 1000.125 + 0.25 * i) for i in range(2)]
        assert found == [OLDER, None]
        assert offer(gate, 50.125, 1000.375) is OLDER


class TestSuccessor:
    """Another publisher than the one before, perhaps with a clock of its own."""

    @staticmethod
    def offer(gate: StampGate, seconds: float, now: float) -> SampleReason | None:
        reason = gate.judge(stamp(seconds), b"successor", now, is_successor=True)
        if reason is None:
            gate.hold(b"successor", now)
        return reason

    def test_its_delay_counts_from_zero(self, gate: StampGate) -> None:
        offer(gate, 100.125, 1000.375)
        assert gate.delay_s > 0.2
        assert self.offer(gate, 100.25, 1000.625) is None
        assert (gate.delay_s, gate.step_told_until) == (0.0, -math.inf)
        assert offer(gate, 100.375, 1001.0) is None
        assert gate.delay_s == pytest.approx(0.25 - 0.000375)

    @pytest.mark.parametrize(("stamp_s", "now"), [(100.125, 1000.5), (100.5, 1000.125)])
    def test_the_limit_itself_is_neither_late_nor_a_step(self, stamp_s: float, now: float) -> None:
        since_s, step_s = now - 1000.0, stamp_s - 100.0
        gate = StampGate(abs(since_s * (1.0 - FORGET_RATE) - step_s))
        offer(gate, 100.0, 1000.0)
        assert self.offer(gate, stamp_s, now) is None
        assert (gate.delay_s, gate.step_told_until) == (0.0, -math.inf)

    def test_a_clock_behind_is_taken_when_its_stamps_go_on(self, gate: StampGate) -> None:
        found = [self.offer(gate, 101.0 + 0.125 * i, 1005.0 + 0.125 * i) for i in range(3)]
        assert found == [DELAYED, DELAYED, None]
        assert (gate.delay_s, gate.steps_back, gate.step_told_until) == (0.0, 0, 1006.25)
        assert offer(gate, 101.375, 1005.375) is None

    def test_so_is_one_that_begins_before_the_held_stamp(self, gate: StampGate) -> None:
        found = [self.offer(gate, 99.9 + 0.125 * i, 1005.0 + 0.125 * i) for i in range(3)]
        assert found == [OLDER, DELAYED, None]

    def test_a_single_sample_from_before_is_refused(self, gate: StampGate) -> None:
        for seconds in (1.0, 2.0, 3.0):
            assert self.offer(gate, 100.25 + seconds / 8, 1001.0 + seconds) is DELAYED

    def test_one_that_is_older_by_less_than_the_limit_is_refused_too(self, gate: StampGate) -> None:
        assert self.offer(gate, 99.875, 1000.125) is OLDER

    def test_what_was_held_is_no_news_from_it_either(self, gate: StampGate) -> None:
        assert self.offer(gate, 100.0, 1005.0) is SampleReason.STAMP_STANDS_STILL
        held = gate.judge(stamp(100.0), b"said before.held", 1005.0, is_successor=True)
        assert held is SampleReason.DUPLICATE

    def test_the_publisher_of_before_is_not_searched(self, gate: StampGate) -> None:
        found = [offer(gate, 101.0 + 0.125 * i, 1005.0 + 0.125 * i) for i in range(9)]
        assert found == [DELAYED] * 9

    def test_a_clock_ahead_is_taken_at_once(self, gate: StampGate) -> None:
        assert self.offer(gate, 900.0, 1001.0) is None
        assert gate.step_told_until == 1002.0


class TestStep:
    def test_back_is_told_for_a_second_after_the_search(self, gate: StampGate) -> None:
        for i in range(2):
            assert offer(gate, 50.0 + 0.125 * i, 1000.125 + 0.125 * i) is OLDER
            assert gate.step_told_until == -math.inf
        assert offer(gate, 50.25, 1000.375) is None
        assert gate.step_told_until == 1001.375
        assert offer(gate, 50.375, 1000.5) is None
        assert gate.step_told_until == 1001.375

    def test_what_is_judged_but_not_held_is_none(self, gate: StampGate) -> None:
        for i in range(5):
            gate.judge(stamp(50.0 + 0.125 * i), b"", 1000.125 + 0.125 * i)
        assert gate.judge(stamp(200.0), b"", 1000.75) is None
        assert (gate.steps_back, gate.step_told_until) == (0, -math.inf)
        assert offer(gate, 100.75, 1000.75) is None
        assert (gate.steps_back, gate.step_told_until) == (0, -math.inf)

    @pytest.mark.parametrize(("early_s", "is_told"), [(0.499, False), (0.501, True), (9e8, True)])
    def test_forward_shows_in_a_sample_that_is_too_quick(
        self, gate: StampGate, early_s: float, is_told: bool
    ) -> None:
        assert offer(gate, 100.125 + early_s, 1000.125) is None
        assert gate.step_told_until == (1001.125 if is_told else -math.inf)
        assert (gate.steps_back, gate.delay_s) == (0, 0.0)

    def test_the_limit_itself_is_no_step(self) -> None:
        gate = StampGate(0.5 - 0.125 * (1.0 - FORGET_RATE))
        offer(gate, 100.0, 1000.0)
        assert offer(gate, 100.5, 1000.125) is None
        assert gate.step_told_until == -math.inf

    def test_a_delay_that_ends_is_none(self, gate: StampGate) -> None:
        assert offer(gate, 100.125, 1000.5) is None
        assert gate.delay_s == pytest.approx(0.3745)
        assert offer(gate, 100.625 + 0.25, 1000.625) is None
        assert gate.step_told_until == -math.inf

    def test_it_goes_on_being_told_when_the_stamps_are_forgotten(self, gate: StampGate) -> None:
        offer(gate, 200.0, 1000.125)
        gate.forget()
        assert gate.step_told_until == 1001.125

    def test_after_a_pause_nobody_can_tell(self, gate: StampGate) -> None:
        assert offer(gate, 200.0, 1010.125) is None
        assert (gate.steps_back, gate.step_told_until) == (0, -math.inf)
        offer(gate, 900.0, 1010.25)
        assert offer(gate, 50.0, 1020.5) is None
        assert (gate.steps_back, gate.step_told_until) == (0, 1011.25)


class TestSetBackByLessThanTheLimit:
    """Stamps that were older, and have caught up before they were believed: no delay."""

    @staticmethod
    def drive(gate: StampGate, off_s: float, begin: int, count: int) -> list[SampleReason]:
        """Samples every 1/16 s by a clock that is off; what was refused."""
        times = [(begin + i) / 16 for i in range(count)]
        found = [offer(gate, 100.0 + off_s + at, 1000.0 + at) for at in times]
        return [reason for reason in found if reason is not None]

    def test_it_is_not_remembered_as_a_delay(self, gate: StampGate) -> None:
        assert self.drive(gate, -0.15, 1, 2) == [OLDER] * 2
        assert offer(gate, 100.0375, 1000.1875) is None
        assert (gate.delay_s, gate.steps, gate.steps_back) == (0.0, 1, 0)
        assert gate.step_told_until == -math.inf  # it may as well have been one late sample

    def test_one_that_is_no_jitter_is_told(self) -> None:
        gate = StampGate(1.25)
        offer(gate, 100.0, 1000.0)
        assert self.drive(gate, -0.65, 1, 12) == [OLDER] * 10
        assert (gate.delay_s, gate.steps, gate.steps_back) == (0.0, 1, 0)
        assert gate.step_told_until == 1000.0 + 11 / 16 + STEP_TOLD_S

    def test_however_often(self, gate: StampGate) -> None:
        assert self.drive(gate, 0.0, 1, 159) == []
        for step in range(1, 30):
            reasons = self.drive(gate, -0.2 * step, 160 * step, 160)
            assert set(reasons) <= {OLDER} and len(reasons) < 5
            assert gate.delay_s < 0.05

    def test_a_late_sample_before_one_in_time_is_no_clock(self, gate: StampGate) -> None:
        assert offer(gate, 99.9, 1000.125) is OLDER
        assert offer(gate, 100.25, 1000.25) is None
        assert gate.steps == 0

    def test_a_claim_beyond_the_limit_ago_is_none(self, gate: StampGate) -> None:
        assert offer(gate, 99.875, 1000.125) is OLDER
        assert offer(gate, 100.4, 1000.6251) is None
        assert gate.steps == 0
        assert gate.delay_s == pytest.approx(0.2245, abs=1e-3)

    def test_a_claim_of_the_limit_ago_is_one(self, gate: StampGate) -> None:
        assert offer(gate, 99.875, 1000.125) is OLDER
        assert offer(gate, 100.375, 1000.625) is None
        assert gate.steps == 1

    def test_it_must_be_more_than_half_of_the_claim(self, gate: StampGate) -> None:
        assert offer(gate, 99.875, 1000.125) is OLDER  # 1/4 s behind
        assert offer(gate, 100.1253, 1000.25) is None
        assert gate.steps == 0

    def test_a_stamp_that_stands_still_is_a_claim_as_well(self, gate: StampGate) -> None:
        assert offer(gate, 100.0, 1000.1875) is SampleReason.STAMP_STANDS_STILL
        assert offer(gate, 100.0625, 1000.25) is None
        assert (gate.steps, gate.delay_s) == (1, 0.0)

    def test_a_successor_has_no_claim_of_another(self, gate: StampGate) -> None:
        assert offer(gate, 99.875, 1000.125) is OLDER
        assert gate.judge(stamp(100.0625), b"other", 1000.25, is_successor=True) is None
        gate.hold(b"other", 1000.25)
        assert gate.steps == 0


def two() -> tuple[StampGate, StampGate]:
    """Two inputs of one sender, with samples every 1/16 s for a second."""
    sender = SenderClock()
    both = StampGate(0.5, sender), StampGate(0.5, sender)
    for i in range(17):
        for gate in both:
            assert offer(gate, 100.0 + i / 16, 1000.0 + i / 16) is None
    return both


class TestCommonClock:
    """What all inputs share is the clock, but for what came after a gap."""

    def test_what_all_fall_behind_by_is_the_clock(self) -> None:
        both = two()
        for i in range(1, 160):
            for gate in both:
                assert offer(gate, 101.0 + i / 32, 1001.0 + i / 16) is None
                assert gate.delay_s <= 0.25 + 1 / 32

    def test_what_one_falls_behind_by_is_delay(self) -> None:
        one, other = two()
        found = []
        for i in range(1, 32):
            found.append(offer(one, 101.0 + i / 32, 1001.0 + i / 16))
            assert offer(other, 101.0 + i / 16, 1001.0 + i / 16) is None
        assert found[:15] == [None] * 15
        assert set(found[17:]) == {DELAYED}

    def test_what_all_fall_behind_by_in_a_gap_is_delay(self) -> None:
        both = two()
        for i in range(1, 160):
            for gate in both:
                assert offer(gate, 101.0 + i / 16, 1001.375 + i / 16) is None
        for gate in both:
            assert gate.delay_s == pytest.approx(0.375, abs=0.02)
            assert gate.steps == 0

    def test_beyond_the_limit_all_that_is_the_clock_s_is_forgiven(self) -> None:
        """A delay beside a clock that runs slowly."""
        both = two()
        for gate in both:
            assert offer(gate, 101.0625, 1001.4375) is None  # 3/8 s after a gap
        for i in range(2, 160):
            for gate in both:
                assert offer(gate, 101.03125 + i / 32, 1001.375 + i / 16) is None

    def test_a_delay_that_has_ended_is_forgotten(self) -> None:
        """What all fall behind by later is the clock again."""
        both = two()
        for gate in both:
            assert offer(gate, 101.0625, 1001.4375) is None
            assert offer(gate, 101.5, 1001.5) is None
            assert (gate.delay_s, fallen_s(gate)) == (0.0, 0.0)
        for i in range(1, 160):
            for gate in both:
                assert offer(gate, 101.5 + i / 32, 1001.5 + i / 16) is None

    def test_gaps_that_come_again_are_usual(self) -> None:
        """A sender in slow motion: each gap is longer than before, each step as long."""
        both = two()
        for i in range(1, 400):
            for gate in both:
                assert offer(gate, 101.0 + i / 16, 1001.0 + i / 8) is None
                if i % 4 == 0:
                    gate.fade()

    def test_a_gap_is_unusual_again_after_half_a_minute(self) -> None:
        both = two()
        for gate in both:
            assert offer(gate, 101.25, 1001.25) is None
            for _ in range(60):
                gate.fade()
            assert offer(gate, 101.3125, 1001.3125) is None
            assert offer(gate, 101.5, 1001.6875) is None
            assert fallen_s(gate) == pytest.approx(0.0, abs=1e-3)
            assert gate.delay_s == pytest.approx(0.1875, abs=1e-3)

    def test_a_refused_sample_is_no_gap(self) -> None:
        one, _ = two()
        for i in (1, 2):
            assert offer(one, 100.99, 1001.0 + i / 16) is OLDER
        assert offer(one, 101.125, 1001.1875) is None
        assert fallen_s(one) == pytest.approx(0.0625, abs=1e-3)

    def test_one_alone_is_not_held_against_one_that_is_gone(self) -> None:
        one, _ = two()
        found = [offer(one, 101.0 + i / 32, 1001.0 + i / 16) for i in range(1, 40)]
        assert DELAYED in found

    def test_one_that_begins_is_not_held_against_the_others(self) -> None:
        both = two()
        late = StampGate(0.5, both[0].sender)
        for i in range(1, 320):
            for gate in both if i < 160 else (*both, late):
                assert offer(gate, 101.0 + i / 32, 1001.0 + i / 16) is None

    def test_forgiveness_ends_with_a_clock_that_was_set_forward(self) -> None:
        both = two()
        for i in range(1, 9):
            for gate in both:
                assert offer(gate, 101.0 + i / 16 - 0.03 * i, 1001.0 + i / 16) is None
        for gate in both:
            assert offer(gate, 110.0, 1001.5625) is None
            assert (gate.delay_s, fallen_s(gate)) == (0.0, 0.0)


class TestTwoThatStep:
    """What two inputs see at once needs no long proof."""

    def test_the_second_sample_is_accepted(self) -> None:
        both = two()
        times = [i / 16 for i in range(1, 4)]
        found = [[offer(gate, 91.0 + at, 1001.0 + at) for gate in both] for at in times]
        assert found == [[OLDER] * 2, [None] * 2, [None] * 2]
        assert [gate.steps_back for gate in both] == [1, 1]

    def test_one_alone_waits_for_half_the_limit(self) -> None:
        one, other = two()
        found = []
        for i in range(1, 6):
            found.append(offer(one, 91.0 + i / 16, 1001.0 + i / 16))
            assert offer(other, 101.0 + i / 16, 1001.0 + i / 16) is None
        assert found == [OLDER] * 4 + [None]

    def test_steps_of_another_size_do_not_count(self) -> None:
        one, other = two()
        for i in range(1, 4):
            assert offer(one, 91.0 + i / 16, 1001.0 + i / 16) is OLDER
            assert offer(other, 90.8 + i / 16, 1001.0 + i / 16) is OLDER

    def test_small_ones_may_be_samples_that_overtook_each_other(self) -> None:
        both = two()
        for i in (1, 2):
            for gate in both:
                assert offer(gate, 100.8125 + i / 16, 1001.0 + i / 16) is OLDER

    def test_stamps_that_stand_still_are_no_clock(self) -> None:
        both = two()
        for i in range(1, 20):
            for gate in both:
                assert offer(gate, 101.0, 1001.0 + i / 16) is SampleReason.STAMP_STANDS_STILL


class TestBeginAnew:
    def test_after_a_pause_any_stamp_is_taken(self, gate: StampGate) -> None:
        offer(gate, 100.125, 1000.375)
        assert offer(gate, 50.0, 1010.375) is OLDER
        assert offer(gate, 50.125, 1010.376) is None
        assert gate.delay_s == 0.0

    def test_a_delay_as_well(self, gate: StampGate) -> None:
        assert offer(gate, 100.125, 1010.0) is DELAYED
        assert offer(gate, 100.125, 1010.001) is None

    def test_to_forget_is_to_hold_nothing(self, gate: StampGate) -> None:
        offer(gate, 100.125, 1000.375)
        offer(gate, 50.0, 1000.5)
        gate.forget()
        assert gate.delay_s == 0.0
        assert offer(gate, 100.125, 1000.5) is None
        assert offer(gate, 50.0, 1000.75) is OLDER


class TestWhatIsUnusual:
    """Step of the stamp, time since: the delay is the difference, but for what is forgotten."""

    @pytest.mark.parametrize(
        ("seconds", "now"),
        [
            (100.125, 1000.125),  # as it should be
            (100.125, 1000.375),  # a delay of all but half the limit
            (100.624, 1000.125),  # quicker by all but the limit
            (110.0, 1010.0),  # after the longest pause
        ],
    )
    def test_what_gives_no_reason_to_look_is_not_told(
        self, gate: StampGate, seconds: float, now: float
    ) -> None:
        assert self.told(gate, stamp(seconds), now) == (None, 0)

    @pytest.mark.parametrize(
        ("seconds", "now", "reason"),
        [
            (100.125, 1000.376, None),  # delayed by more than half the limit
            (100.627, 1000.125, None),  # too quick: the clock was set
            (110.125, 1010.125, None),  # after a pause
            (100.0, 1000.125, SampleReason.STAMP_STANDS_STILL),
            (99.875, 1000.125, OLDER),
            (100.125, 1000.75, DELAYED),
        ],
    )
    def test_everything_else_is(
        self, gate: StampGate, seconds: float, now: float, reason: SampleReason | None
    ) -> None:
        assert self.told(gate, stamp(seconds), now) == (reason, 1)

    def test_so_is_what_is_no_time_and_what_comes_from_another(self, gate: StampGate) -> None:
        assert self.told(gate, Time(100, 10**9), 1001.0) == (SampleReason.BAD_STAMP, 1)
        assert self.told(gate, stamp(100.125), 1000.125, is_successor=True) == (None, 1)

    def test_a_step_of_a_nanosecond_is_usual(self, gate: StampGate) -> None:
        assert self.told(gate, Time(100, 1), 1000.125) == (None, 0)

    def test_quicker_by_the_limit_itself_is_usual(self) -> None:
        gate = StampGate(0.5 - 0.125 * (1.0 - FORGET_RATE))
        offer(gate, 100.0, 1000.0)
        assert self.told(gate, stamp(100.5), 1000.125) == (None, 0)

    def test_half_the_limit_itself_is_usual(self) -> None:
        gate = StampGate(2.0 * (0.375 * (1.0 - FORGET_RATE) - 0.125))
        offer(gate, 100.0, 1000.0)
        assert self.told(gate, stamp(100.125), 1000.375) == (None, 0)

    @pytest.mark.parametrize(("now", "delay_s"), [(1000.375, 0.25), (1000.5, 0.375)])
    def test_a_delay_is_held_all_the_same(
        self, gate: StampGate, now: float, delay_s: float
    ) -> None:
        assert offer(gate, 100.125, now) is None
        assert gate.delay_s == pytest.approx(delay_s, abs=1e-3)

    def test_nobody_need_listen(self) -> None:
        assert StampGate(0.5).judge(stamp(100.0), b"", 1000.0) is None

    @staticmethod
    def told(
        gate: StampGate, at: Time, now: float, is_successor: bool = False
    ) -> tuple[SampleReason | None, int]:
        """What a sample is refused for, and how often it is told."""
        calls: list[None] = []
        gate.on_unusual = lambda: calls.append(None)
        return gate.judge(at, b"other", now, is_successor), len(calls)
