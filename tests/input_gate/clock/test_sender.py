# SPDX-License-Identifier: Apache-2.0
"""The common clock of several inputs: what they share, and at which rate it runs."""

from __future__ import annotations

import pytest

from safety_island.input_gate.clock import sender
from safety_island.input_gate.clock.sender import AGREE_S, WINDOW_S
from safety_island.input_gate.sender_clock import LARGEST_RATE_ERROR, SenderClock
from tests.input_gate.clock.other import NEVER, Input


@pytest.fixture
def clock() -> SenderClock:
    return SenderClock()


def three(clock: SenderClock, *fallen_s: float) -> list[Input]:
    return [Input(clock, one) for one in fallen_s]


class TestCommonFall:
    def test_the_least_is_forgiven_to_all(self, clock: SenderClock) -> None:
        inputs = three(clock, 0.5, 0.25, 0.375)
        sender.forgive_common(clock.stamps, 0, 0.75, 0.0, 9.0)
        assert [one.fallen for one in inputs] == [0.25, 0.0, 0.125]

    def test_it_may_be_that_of_the_one_that_asks(self, clock: SenderClock) -> None:
        inputs = three(clock, 0.0, 0.5, 0.375)
        sender.forgive_common(clock.stamps, 0, 0.25, 0.0, 9.0)
        assert [one.fallen for one in inputs] == [-0.25, 0.25, 0.125]

    @pytest.mark.parametrize("noise_s", [0.25, 0.5])
    def test_what_is_noise_is_left(self, clock: SenderClock, noise_s: float) -> None:
        inputs = three(clock, 0.5, 0.25)
        sender.forgive_common(clock.stamps, 0, 0.5, noise_s, 9.0)
        assert [one.fallen for one in inputs] == [0.5, 0.25]

    def test_one_that_has_not_fallen_behind_proves_delay(self, clock: SenderClock) -> None:
        inputs = three(clock, 0.5, 0.0, 0.5)
        sender.forgive_common(clock.stamps, 0, 0.5, 0.0, 9.0)
        assert [one.fallen for one in inputs] == [0.5, 0.0, 0.5]

    def test_one_that_is_not_heard_proves_nothing(self, clock: SenderClock) -> None:
        inputs = three(clock, 0.5, 0.0, 0.5)
        inputs[1].heard = False
        sender.forgive_common(clock.stamps, 0, 0.5, 0.0, 9.0)
        assert [one.fallen for one in inputs] == [0.0, 0.0, 0.0]

    def test_one_alone_has_no_common_clock(self, clock: SenderClock) -> None:
        inputs = three(clock, 0.5, 0.5)
        inputs[1].heard = False
        sender.forgive_common(clock.stamps, 0, 0.5, 0.0, 9.0)
        assert inputs[0].fallen == 0.5

    def test_the_furthest_of_the_others(self, clock: SenderClock) -> None:
        inputs = three(clock, 0.9, 0.25, 0.5)
        assert sender.furthest_of_others(clock.stamps, 0, 9.0) == 0.5
        inputs[2].heard = False
        assert sender.furthest_of_others(clock.stamps, 0, 9.0) == 0.25
        inputs[1].heard = False
        assert sender.furthest_of_others(clock.stamps, 0, 9.0) == 0.0


class TestStep:
    @pytest.mark.parametrize(
        ("claimed_s", "ago_s", "found"),
        [
            (3.0, 0.0, True),
            (3.125, 0.0, True),
            (2.875, 0.0, True),
            (3.126, 0.0, False),
            (2.874, 0.0, False),
            (3.0, AGREE_S, True),
            (3.0, 1.001, False),
        ],
    )
    def test_another_input_has_seen_it(
        self, clock: SenderClock, claimed_s: float, ago_s: float, found: bool
    ) -> None:
        one, other = three(clock, 0.0, 0.0)
        one.claimed_s = 3.0
        other.claimed_s, other.claimed_at = claimed_s, 9.0 - ago_s
        assert sender.has_stepped(clock.stamps, 0, 9.0) == found

    def test_its_own_claim_is_no_proof(self, clock: SenderClock) -> None:
        one, _ = three(clock, 0.0, 0.0)
        one.claimed_s, one.claimed_at = 3.0, 9.0
        assert not sender.has_stepped(clock.stamps, 0, 9.0)


def test_the_time_by_the_sender_is_the_highest_stamp(clock: SenderClock) -> None:
    inputs = three(clock, 0.0, 0.0, 0.0)
    for one, stamp_ns in zip(inputs, (5, 9, 7), strict=True):
        one.held_ns = stamp_ns
    assert clock.stamp_ns(9.0) == 9
    inputs[1].heard = False
    assert clock.stamp_ns(9.0) == 7
    inputs[0].heard = inputs[2].heard = False
    assert clock.stamp_ns(9.0) is None


class TestRate:
    """Windows of 2.5 s; the stamps advance by ``rates`` in each."""

    @staticmethod
    def windows(clock: SenderClock, *rates: tuple[float, ...]) -> list[float]:
        """The error of the rate after each window."""
        inputs = three(clock, *[0.0 for _ in rates[0]])
        for one in inputs:
            one.held_ns, one.held_at = 10**9, 100.0
        clock.measure(100.0)
        found = []
        for window in rates:
            for one, rate in zip(inputs, window, strict=True):
                one.held_ns += round(rate * WINDOW_S * 1e9)
                one.held_at += WINDOW_S
            clock.measure(inputs[0].held_at)
            found.append(clock.rate_error)
        return found

    def test_the_numbers(self) -> None:
        assert (WINDOW_S, LARGEST_RATE_ERROR, AGREE_S) == (2.5, 0.01, 1.0)
        assert (SenderClock().rate_error, SenderClock().is_off) == (0.0, False)

    @pytest.mark.parametrize("rate", [0.5, 0.95, 1.0, 1.05, 2.0])
    def test_a_rate_shows_in_two_windows(self, clock: SenderClock, rate: float) -> None:
        found = self.windows(clock, (rate,) * 4, (rate,) * 4)
        assert found == [0.0, pytest.approx(rate - 1.0)]
        assert clock.is_off is (rate != 1.0)

    @pytest.mark.parametrize(("rate", "is_off"), [(0.9901, False), (0.9899, True), (1.0101, True)])
    def test_one_percent_is_told(self, clock: SenderClock, rate: float, is_off: bool) -> None:
        self.windows(clock, (rate,) * 3, (rate,) * 3)
        assert clock.is_off is is_off

    def test_a_step_or_a_delay_shows_in_one(self, clock: SenderClock) -> None:
        assert self.windows(clock, (0.9,) * 4, (1.0,) * 4, (0.9,) * 4) == [0.0] * 3

    def test_to_and_fro_is_none(self, clock: SenderClock) -> None:
        assert self.windows(clock, (0.9,) * 4, (1.1,) * 4) == [0.0, 0.0]

    def test_the_least_counts(self, clock: SenderClock) -> None:
        found = self.windows(clock, (0.9, 0.8, 0.9, 0.7), (0.95,) * 4)
        assert found == [0.0, pytest.approx(-0.05)]

    def test_one_that_differs_does_not_count(self, clock: SenderClock) -> None:
        found = self.windows(clock, (0.9, 0.9, 0.9, 1.0), (0.9, 0.9, 0.9, 1.0))
        assert found == [0.0, pytest.approx(-0.1)]

    @pytest.mark.parametrize(
        ("rates", "error"),
        [
            ((1.1, 1.1, 1.0), 0.1),
            ((0.9, 0.9, 1.0), -0.1),
            ((1.1, 1.0, 1.0), 0.0),
            ((0.9, 1.0), 0.0),
            ((1.1, 1.0), 0.0),
        ],
    )
    def test_of_three_the_middle_one_counts_and_two_must_agree(
        self, clock: SenderClock, rates: tuple[float, ...], error: float
    ) -> None:
        assert self.windows(clock, rates, rates)[-1] == pytest.approx(error)

    def test_one_alone_is_off_by_itself(self, clock: SenderClock) -> None:
        assert self.windows(clock, (1.0, 1.0, 1.0, 0.9), (1.0, 1.0, 1.0, 0.9)) == [0.0, 0.0]

    def test_one_input_is_no_common_rate(self, clock: SenderClock) -> None:
        assert self.windows(clock, (0.5,), (0.5,)) == [0.0, 0.0]

    def test_a_window_is_not_over_before_its_time(self, clock: SenderClock) -> None:
        inputs = three(clock, 0.0, 0.0)
        for one in inputs:
            one.held_ns, one.held_at = 10**9, 100.0
        clock.measure(100.0)
        for one in inputs:
            one.held_ns, one.held_at = 2 * 10**9, 102.499
        clock.measure(102.499)
        clock.measure(102.5)
        clock.measure(105.0)
        assert clock.rate_error == 0.0

    @pytest.mark.parametrize("change", ["stepped", "late", "new", "short"])
    def test_what_cannot_be_measured(self, clock: SenderClock, change: str) -> None:
        inputs = three(clock, 0.0, 0.0)
        for now in (100.0, 102.5, 105.0):
            for one in inputs:
                one.held_ns, one.held_at = round(now * 0.5e9), now
            if change == "stepped":
                inputs[0].steps += 1
            elif now < {"late": 101.0, "new": 104.0}.get(change, 0.0):
                inputs[0].held_at = NEVER
            elif change == "short" and now > 102.0:
                inputs[0].held_at = 101.0
            clock.measure(now)
        assert clock.rate_error == 0.0
