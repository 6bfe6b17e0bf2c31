# SPDX-License-Identifier: Apache-2.0
"""Each warning by its own cause, and all at once."""

from __future__ import annotations

import pytest

from safety_island.input_gate.rate import RateMeter
from safety_island.input_gate.stamps import StampGate
from safety_island.input_gate.warning import EXPLANATIONS, InputWarning
from safety_island.input_gate.warnings import warnings
from safety_island.input_gate.writers import Writers

A, B = b"a" * 16, b"b" * 16


def told(
    delay_s: float = 0.0,
    low: bool = False,
    guids: int = 0,
    now: float = 9.0,
    old: bool = False,
    off: bool = False,
    step_until: float = 8.0,
    turned: bool = False,
    rate_error: float = 0.0,
) -> int:
    stamps, rate, writers = StampGate(0.5), RateMeter(8.0), Writers(3)
    stamps.state["delay_s"], rate.too_low = delay_s, low
    stamps.state["step_told_until"] = step_until
    stamps.sender.state["rate_error"] = rate_error
    if guids:
        writers.update(frozenset({A}), 0.0)
        writers.update(frozenset({B, A} if guids > 1 else {B}), 8.0)
    return warnings(now, stamps, writers, rate, old, off, turned)


@pytest.mark.parametrize(
    ("bits", "found"),
    [
        (InputWarning(0), told()),
        (InputWarning.AGE, told(old=True)),
        (InputWarning.RATE, told(low=True)),
        (InputWarning.CLOCK, told(off=True)),
        (InputWarning(0), told(delay_s=0.25)),
        (InputWarning.DELAY, told(delay_s=0.2501)),
        (InputWarning.PUBLISHER_CHANGED, told(guids=1)),
        (InputWarning(0), told(guids=1, now=9.01)),
        (InputWarning.SECOND_PUBLISHER, told(guids=2, now=9.01)),
        (InputWarning.CLOCK_STEP, told(step_until=9.0)),
        (InputWarning(0), told(step_until=8.99)),
        (InputWarning.YAW_REPLACED, told(turned=True)),
        (InputWarning.CLOCK_RATE, told(rate_error=-0.0101)),
        (InputWarning.CLOCK_RATE, told(rate_error=0.0101)),
        (InputWarning(0), told(rate_error=0.01)),
        (InputWarning(511), told(1.0, True, 2, 9.0, True, True, 9.5, True, 1.0)),
    ],
)
def test_each_cause_has_its_bit(bits: InputWarning, found: int) -> None:
    assert found == bits


def test_every_warning_is_explained() -> None:
    assert list(EXPLANATIONS) == list(InputWarning)
    assert [int(bit) for bit in InputWarning] == [1 << place for place in range(9)]
    assert all(meaning and action for meaning, action in EXPLANATIONS.values())
