# SPDX-License-Identifier: Apache-2.0
"""What the guard did to the commands of a replay."""

from __future__ import annotations

from collections import Counter
from typing import NamedTuple

import numpy as np

from safety_island.guard import Limit, Verdict
from safety_island.messages.status import NO_VALUE
from safety_island.replay.check import Table

VERDICT, LIMITS = "guard_verdict", "guard_limits"
GUARD_COLUMNS = (VERDICT, LIMITS)
"""Columns of a replay: the guard's Verdict (NO_VALUE: it was not asked), and its Limit bits."""


class Act(NamedTuple):
    """A command that the guard changed or refused."""

    tick: int
    verdict: Verdict
    limits: Limit

    def __str__(self) -> str:
        """One clause for a person."""
        return f"the guard {self.verdict.name.lower()} it ({', '.join(names_of(self.limits))})"


class GuardActs(NamedTuple):
    """How many commands the guard was asked about, and what it did not let pass as they were."""

    commands: int = 0
    acts: tuple[Act, ...] = ()

    def count(self, verdict: Verdict) -> int:
        """Return how many commands got a verdict that is not PASSED."""
        return sum(act.verdict is verdict for act in self.acts)

    def limits(self) -> dict[str, int]:
        """Return the limits that acted, each with the number of commands that it acted on."""
        return dict(Counter(name for act in self.acts for name in names_of(act.limits)))

    def at(self, tick: int) -> Act | None:
        """Return what was done in a tick; None when its command passed, or there was none."""
        return next((act for act in self.acts if act.tick == tick), None)


def names_of(limits: Limit) -> list[str]:
    """Return the names of limits, as the status has them."""
    return [str(limit.name) for limit in limits]


def guard_acts(replayed: dict[str, Table]) -> GuardActs:
    """Read GUARD_COLUMNS of a replay."""
    verdicts, limits = (replayed[name].astype(int) for name in GUARD_COLUMNS)
    asked = verdicts != NO_VALUE
    ticks = np.flatnonzero(asked & (verdicts != Verdict.PASSED)).tolist()
    acts = (Act(tick, Verdict(verdicts[tick]), Limit(int(limits[tick]))) for tick in ticks)
    return GuardActs(int(asked.sum()), tuple(acts))
