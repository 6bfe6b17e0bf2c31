# SPDX-License-Identifier: Apache-2.0
"""All that is remembered of the stamps of the inputs. Times in s, monotonic, unless they end in ns.

Copying the bytes of both records is a snapshot.
"""

from __future__ import annotations

import math

import numpy as np

from safety_island.kernel.records import Records, record

MAX_INPUTS = 5
"""Inputs whose stamps are compared."""

STAMPS = record(
    [
        ("limit_s", "f8"),  # age limit; 0: no input has this place
        # the sample that is held, which was the last good one
        ("held_ns", "i8"),  # its stamp; -1: none is held
        ("held_at", "f8"),  # when it came
        ("delay_s", "f8"),  # how much longer it took than the quickest one
        # the sample that was judged last
        ("stamp_ns", "i8"),  # its stamp
        ("new_delay_s", "f8"),  # its delay; STEPPED or CAUGHT_UP where the clock was set
        ("new_forgiven_s", "f8"),  # what is counted as the clock's then
        ("is_unusual", "?"),  # it gives reason to look at delay and clock
        # what its stamps have fallen behind by
        ("forgiven_s", "f8"),  # counted as the clock's
        ("after_gap_s", "f8"),  # grown while nothing came
        ("usual_gap_s", "f8"),  # between two samples
        ("longest_gap_s", "f8"),
        ("refused_at", "f8"),  # when a stamp that is not newer was refused last
        # steps of the sender's clock
        ("claimed_s", "f8"),  # how far behind it is by the refused samples,
        ("claimed_at", "f8"),  # and when these came last
        ("steps", "i8"),  # times that it was set
        ("steps_back", "i8"),  # and of these, back
        ("step_told_until", "f8"),  # until when a step is reported
        # the search for a clock behind stamps that do not fit
        ("seen_at", "f8"),  # when one came last
        ("seen_ns", "i8"),  # it
        ("since", "f8"),  # since when they advance
        # when the rate was measured last
        ("mark_ns", "i8"),  # held_ns
        ("mark_at", "f8"),  # held_at
        ("mark_steps", "i8"),  # steps
    ]
)
"""The stamps of one input."""

CLOCK = record(
    [
        ("rate_error", "f8"),  # common rate of the stamps, less 1: the least of two windows
        ("last_error", "f8"),  # that of the last window alone
        ("marked_at", "f8"),  # when it was measured
        ("time_ns", "i8"),  # by the sender's clock, as it was asked for last
    ]
)
"""The clock of the sender of all inputs."""


def new_stamps() -> Records:
    """Return the memory of MAX_INPUTS inputs, none of which is there yet."""
    stamps: Records = np.zeros(MAX_INPUTS, STAMPS)
    forget(stamps)
    stamps["step_told_until"] = stamps["mark_at"] = -math.inf
    return stamps


def new_clock() -> Records:
    """Return the memory of a clock that was never measured."""
    clock: Records = np.zeros(1, CLOCK)
    clock["marked_at"] = -math.inf
    return clock


def forget(stamps: Records) -> None:
    """Let inputs hold nothing: the next sample of each is good whatever its stamp."""
    for name in ("delay_s", "new_delay_s", "new_forgiven_s", "forgiven_s", "after_gap_s"):
        stamps[name] = 0.0
    for name in ("usual_gap_s", "longest_gap_s", "claimed_s", "since"):
        stamps[name] = 0.0
    for name in ("held_at", "refused_at", "claimed_at", "seen_at"):
        stamps[name] = -math.inf
    stamps["held_ns"], stamps["seen_ns"] = -1, 0
