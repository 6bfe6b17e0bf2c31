# SPDX-License-Identifier: Apache-2.0
"""Which warnings about an input stand now."""

from __future__ import annotations

from safety_island.input_gate.latched import LatchedGate
from safety_island.input_gate.rate import RateMeter
from safety_island.input_gate.stamps import StampGate
from safety_island.input_gate.warning import InputWarning
from safety_island.input_gate.writers import Writers

_AGE, _RATE, _CLOCK = int(InputWarning.AGE), int(InputWarning.RATE), int(InputWarning.CLOCK)
_DELAY, _SECOND = int(InputWarning.DELAY), int(InputWarning.SECOND_PUBLISHER)
_CHANGED, _STEP = int(InputWarning.PUBLISHER_CHANGED), int(InputWarning.CLOCK_STEP)
_CLOCK_RATE = int(InputWarning.CLOCK_RATE)
_TURNED = int(InputWarning.YAW_REPLACED)


def warnings(
    now: float,
    stamps: StampGate | LatchedGate,
    writers: Writers,
    rate: RateMeter,
    is_old: bool,
    is_off: bool,
    is_turned: bool,
) -> int:
    """Return the bits of InputWarning at ``now`` [s, monotonic].

    ``is_old``: it is older than is warned of; ``is_off``: its stamp is far from the wall clock;
    ``is_turned``: orientations in it were replaced.
    """
    bits = _AGE if is_old else 0
    if rate.too_low:
        bits |= _RATE
    if is_off:
        bits |= _CLOCK
    if stamps.delay_s > stamps.usual_delay_s:
        bits |= _DELAY
    if writers.others:
        bits |= _SECOND
    if writers.changed(now):
        bits |= _CHANGED
    if now <= stamps.step_told_until:
        bits |= _STEP
    if stamps.sender.is_off:
        bits |= _CLOCK_RATE
    if is_turned:
        bits |= _TURNED
    return bits
