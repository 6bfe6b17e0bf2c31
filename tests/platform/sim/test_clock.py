# SPDX-License-Identifier: Apache-2.0
"""Actions in virtual time."""

from __future__ import annotations

from collections.abc import Callable

from safety_island.platform import LogConfig
from safety_island.platform.sim import make
from safety_island.platform.sim.clock import START_NS, SimClock


def test_actions_happen_in_the_order_of_their_times_and_then_of_the_calls() -> None:
    clock = SimClock(0)
    seen: list[tuple[str, int]] = []

    def note(name: str) -> Callable[[], None]:
        return lambda: seen.append((name, clock.monotonic_ns()))

    for name, time_ns in (("late", 30), ("first", 10), ("second", 10), ("beyond", 51)):
        clock.call_at(time_ns, note(name))
    clock.advance_to_ns(50)
    assert seen == [("first", 10), ("second", 10), ("late", 30)]
    assert clock.monotonic_ns() == 50


def test_an_action_that_takes_long_delays_the_next_ones() -> None:
    clock = SimClock(0)
    seen: list[int] = []
    clock.call_at(10, lambda: clock.advance_to_ns(40))
    clock.call_at(20, lambda: seen.append(clock.monotonic_ns()))
    clock.advance_to_ns(30)
    assert seen == [20]
    assert clock.monotonic_ns() == 40


def test_an_action_in_the_past_happens_at_the_next_advance() -> None:
    clock = SimClock(100)
    seen: list[int] = []
    clock.call_at(10, lambda: seen.append(clock.monotonic_ns()))
    clock.advance_to_ns(50)
    assert (seen, clock.monotonic_ns()) == ([100], 100)


def test_the_timer_lets_the_actions_between_two_ticks_happen() -> None:
    platform = make(LogConfig())
    clock = platform.clock
    seen: list[float] = []

    def plant() -> None:
        seen.append(clock.now())
        clock.call_at(clock.monotonic_ns() + 40_000_000, plant)

    clock.call_at(START_NS + 40_000_000, plant)
    timer = platform.new_timer(0.1)
    assert timer.wait() == (START_NS + 100_000_000, 0, 0)
    assert seen == [1000.04, 1000.08]


def test_an_action_may_wake_the_timer_and_time_stands_there() -> None:
    platform = make()
    timer = platform.new_timer(1.0)
    platform.clock.call_at(START_NS + 10, timer.wake)
    assert timer.wait() is None
    assert timer.wait() == (START_NS + 10**9, 0, 0)


def test_a_network_address_may_come_later() -> None:
    platform = make()
    network = platform.network
    late = START_NS + 2 * 10**9
    platform.clock.call_at(late, lambda: network.addresses.update(sim1="10.0.0.2"))
    assert network.wait_for_address("sim1", 10.0) == "10.0.0.2"
    assert platform.clock.monotonic_ns() == late
