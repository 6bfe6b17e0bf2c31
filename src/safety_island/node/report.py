# SPDX-License-Identifier: Apache-2.0
"""What one tick did: returned by the node, read by live views, tests and later the status."""

from __future__ import annotations

from enum import IntEnum
from pathlib import PurePath
from typing import NamedTuple

from safety_island.life_cycle.transition import Life
from safety_island.messages.outputs import Control
from safety_island.node.outgoing import OutgoingControl


class Outcome(IntEnum):
    """Whether a tick sent its command, and if not, why."""

    PUBLISHED = 0
    """The command went out on every output that could take it, at least one."""
    WAITING_FOR_INPUT = 1
    """An input was never received, or never accepted."""
    NOT_READY = 2
    """A controller has nothing that it could follow yet."""
    STALE = 3
    """The lateral or the longitudinal command was older than the limit."""
    NOT_FINITE = 4
    """The command held a number that is none."""
    OUTPUT_FAILED = 5
    """No output could take the command."""
    FAULT = 6
    """The tick ended with an exception: a fault of the program."""
    REFUSED = 7
    """The guard refused the command."""
    FORBIDDEN = 8
    """The life cycle lets nothing out."""
    SUBSTITUTED = 9
    """The last command or one of the stop ramp went out in place of the controllers'."""


_PUBLISHED, _SUBSTITUTED = Outcome.PUBLISHED, Outcome.SUBSTITUTED


class TickReport(NamedTuple):
    """One tick. Times in seconds; ages run from the acceptance of an input, inf when never."""

    number: int
    """Counts from 1."""
    now: float
    """Start of the tick on the monotonic clock [s]."""
    outcome: Outcome
    detail: str
    """What was missing, stale or wrong; empty when published."""
    life: Life
    """State and reason after the tick."""
    subject: int
    """The input that the reason is about, NO_SUBJECT for none."""
    lateness_s: float
    """How long after its place on the grid the tick started."""
    skipped: int
    """Ticks missed since the tick before."""
    tick_time_s: float
    """From the first input to the last output."""
    lateral_time_s: float
    longitudinal_time_s: float
    ages_s: tuple[float, ...]
    """Age of each input, in the order of ``inputs.INPUTS``."""
    refused: int
    """Samples that were refused in this tick; ``ControllerNode.inputs`` has the reasons."""
    outgoing: OutgoingControl | None
    """The command as its message, also when it was not sent; None when there was none."""

    @property
    def command(self) -> Control | None:
        """The command, also when it was not sent; None when there was none."""
        return None if self.outgoing is None else self.outgoing.control

    @property
    def sent(self) -> bool:
        """Whether any command went out, be it the controllers' or one in their place."""
        outcome = self.outcome
        return outcome is _PUBLISHED or outcome is _SUBSTITUTED

    @property
    def published(self) -> bool:
        """Whether the command of this tick went out."""
        return self.outcome is _PUBLISHED


def describe(error: Exception) -> str:
    """Return kind and text of an exception, with the file and line where it arose."""
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    if trace is None:
        return f"{type(error).__name__}: {error}"
    file = "/".join(PurePath(trace.tb_frame.f_code.co_filename).parts[-2:])
    return f"{type(error).__name__}: {error} ({file}:{trace.tb_lineno})"
