# SPDX-License-Identifier: Apache-2.0
"""What must hold for any stream of stamps."""

from __future__ import annotations

from itertools import pairwise

from hypothesis import given, settings
from hypothesis import strategies as st

from safety_island.input_gate.reason import SampleReason
from safety_island.input_gate.stamps import StampGate
from safety_island.messages.wire import Time

LIMIT_S = 0.5
S = 1_000_000_000
BASE_NS = 1_000_000 * S

Arrival = tuple[int, int]
"""Stamp and time of arrival, both in ns."""


def feed(arrivals: list[Arrival]) -> tuple[StampGate, list[SampleReason | None]]:
    gate, reasons = StampGate(LIMIT_S), []
    for stamp_ns, now_ns in arrivals:
        data = stamp_ns.to_bytes(8, "big")
        reasons.append(gate.judge(Time.from_nanoseconds(stamp_ns), data, now_ns / S))
        if reasons[-1] is None:
            gate.hold(data, now_ns / S)
    return gate, reasons


def held(arrivals: list[Arrival]) -> list[Arrival]:
    """What was held, one after the other."""
    _, reasons = feed(arrivals)
    return [a for a, reason in zip(arrivals, reasons, strict=True) if reason is None]


steps_ns = st.integers(1, S // 4)


@st.composite
def streams(draw: st.DrawFn) -> list[Arrival]:
    """Samples of a good clock, each on its way for less than the limit lets pass."""
    sent = BASE_NS
    arrivals = []
    for step in draw(st.lists(steps_ns, min_size=1, max_size=30)):
        sent += step
        for delay in draw(st.lists(st.integers(0, S // 5), min_size=1, max_size=3)):
            arrivals.append((sent, sent + delay))
    return sorted(arrivals, key=lambda arrival: arrival[1])


anything = st.lists(st.tuples(st.integers(1, 40), st.integers(0, S)), min_size=1, max_size=40).map(
    lambda rows: timed([(stamp * S // 16, step) for stamp, step in rows])
)


def timed(rows: list[tuple[int, int]]) -> list[Arrival]:
    """Stamps with the steps of time between them."""
    now, arrivals = 0, []
    for stamp, step in rows:
        now += step
        arrivals.append((stamp, now))
    return arrivals


@settings(deadline=None)
@given(streams())
def test_the_held_stamp_never_goes_back_and_none_is_taken_twice(arrivals: list[Arrival]) -> None:
    taken = [stamp for stamp, _ in held(arrivals)]
    assert all(a < b for a, b in pairwise(taken))
    assert taken[-1] == max(stamp for stamp, _ in arrivals)


@settings(deadline=None)
@given(anything)
def test_it_goes_back_only_for_a_clock_that_was_set_back(arrivals: list[Arrival]) -> None:
    taken = held(arrivals)
    for before, after in pairwise(taken):
        assert before[0] != after[0]
        if after[0] > before[0] or after[1] - before[1] > 10 * S:
            continue
        between = [a for a in arrivals if before[1] <= a[1] <= after[1] and a[0] < before[0]]
        assert after[1] - between[0][1] >= LIMIT_S / 2 * S - 1000


@settings(deadline=None)
@given(anything)
def test_equal_stamps_are_refused_by_name(arrivals: list[Arrival]) -> None:
    stamp, now = arrivals[-1]
    gate, reasons = feed([*arrivals, (stamp, now + S), (stamp, now + 20 * S)])
    if reasons[-3] is None:
        assert reasons[-2:] == [SampleReason.DUPLICATE] * 2
    assert gate.stamp_ns == stamp


@settings(deadline=None)
@given(st.lists(st.integers(0, 30 * S), min_size=1, max_size=20))
def test_a_constant_stamp_never_refreshes(steps: list[int]) -> None:
    arrivals = timed([(BASE_NS, step) for step in steps])
    assert held(arrivals) == arrivals[:1]


@settings(deadline=None)
@given(streams(), st.integers(-(10**6) + 1, 10**6))
def test_a_constant_offset_of_the_sender_changes_nothing(
    arrivals: list[Arrival], offset_s: int
) -> None:
    gate, reasons = feed(arrivals)
    shifted, found = feed([(stamp + offset_s * S, now) for stamp, now in arrivals])
    assert found == reasons
    assert (shifted.delay_s, shifted.steps_back) == (gate.delay_s, gate.steps_back)


@settings(deadline=None)
@given(st.integers(-1000, 1000), st.lists(st.integers(S // 100, 9 * S), max_size=60))
def test_drift_up_to_1000_ppm_is_no_delay(ppm: int, steps: list[int]) -> None:
    arrivals = timed([(0, step) for step in steps])
    drifted = [(BASE_NS + now + now * ppm // 10**6, now) for _, now in arrivals]
    gate, reasons = feed(drifted)
    assert reasons == [None] * len(drifted)
    assert gate.delay_s < 1e-6


@settings(deadline=None)
@given(st.integers(60 * S // 100, 5 * S), st.integers(1, 20))
def test_samples_that_all_take_longer_are_refused(delay: int, count: int) -> None:
    first = [(BASE_NS, 0)]
    late = [(BASE_NS + i * S // 8, i * S // 8 + delay) for i in range(1, count)]
    assert held([*first, *late]) == first
