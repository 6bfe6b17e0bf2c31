# SPDX-License-Identifier: Apache-2.0
"""What every clock promises."""

from __future__ import annotations

from tests.platform.rig import Rig


def test_monotonic_time_never_goes_back(rig: Rig) -> None:
    times = [rig.platform.clock.monotonic_ns() for _ in range(1000)]
    assert times == sorted(times)


def test_an_offset_moves_the_wall_clock_and_nothing_else(rig: Rig) -> None:
    clock = rig.platform.clock
    before = clock.monotonic_ns()
    clock.set_wall_offset_ns(3600 * 10**9)
    low, wall, high = clock.monotonic_ns(), clock.wall_ns(), clock.monotonic_ns()
    assert before <= low <= wall - 3600 * 10**9 <= high
    assert low * 1e-9 - 1e-3 <= clock.now() - 3600.0


def test_without_an_offset_the_machine_s_own_wall_clock_counts(rig: Rig) -> None:
    clock = rig.platform.clock
    own = clock.wall_ns()
    clock.set_wall_offset_ns(-clock.monotonic_ns())
    clock.set_wall_offset_ns(None)
    assert clock.wall_ns() >= own
