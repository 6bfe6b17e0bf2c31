# SPDX-License-Identifier: Apache-2.0
"""When a bus that failed is tried again, as a table over time."""

from __future__ import annotations

import pytest

from safety_island.can.recovery import LAST_BACKOFF_S, Recovery, Remedy
from safety_island.platform.interfaces import CanResult

HARD = [
    CanResult.TIMED_OUT,
    CanResult.BUS_OFF,
    CanResult.INTERFACE_DOWN,
    CanResult.NOT_OPEN,
]


def test_nothing_to_do_before_a_failure() -> None:
    assert Recovery().remedy(0.0) is Remedy.NONE


@pytest.mark.parametrize("result", [CanResult.QUEUE_FULL, CanResult.FAILED])
def test_a_full_queue_is_first_emptied(result: CanResult) -> None:
    recovery = Recovery()
    recovery.fail(result, 1.0)
    assert recovery.remedy(1.0) is Remedy.DISCARD
    recovery.fail(result, 1.15)
    assert recovery.remedy(1.3) is Remedy.WAIT
    assert recovery.remedy(1.36) is Remedy.REOPEN


@pytest.mark.parametrize("result", HARD)
def test_what_is_down_is_opened_again_at_the_next_tick(result: CanResult) -> None:
    recovery = Recovery()
    recovery.fail(result, 1.0)
    assert recovery.remedy(1.0) is Remedy.REOPEN
    assert recovery.last is result


def test_the_back_off_doubles_up_to_its_limit() -> None:
    recovery = Recovery()
    now_s, waits = 0.0, []
    for _ in range(9):
        recovery.fail(CanResult.BUS_OFF, now_s)
        begun_s = now_s
        while recovery.remedy(now_s) is Remedy.WAIT:
            now_s += 0.05
        waits.append(round(now_s - begun_s, 6))
    assert waits == pytest.approx([0.0, 0.2, 0.4, 0.8, 1.6, 3.2, 5.0, 5.0, 5.0], abs=0.051)
    assert max(waits) <= LAST_BACKOFF_S + 0.05


def test_success_ends_it() -> None:
    recovery = Recovery()
    for _ in range(100):
        recovery.fail(CanResult.BUS_OFF, 1.0)
    recovery.succeed()
    assert (recovery.failures, recovery.remedy(0.0)) == (0, Remedy.NONE)
    recovery.fail(CanResult.BUS_OFF, 2.0)
    assert recovery.remedy(2.0) is Remedy.REOPEN
