# SPDX-License-Identifier: Apache-2.0
"""The last check before a command goes out, and what it says when one must not."""

from __future__ import annotations

from typing import NamedTuple

from safety_island.core.guard import Guard, Proposal
from safety_island.guard import Limit, Verdict
from safety_island.life_cycle.reason import Reason
from safety_island.messages.status import NO_VALUE
from safety_island.node.command import Computed
from safety_island.node.report import Outcome
from safety_island.platform.interfaces import Logger


class Checked(NamedTuple):
    """A command that may go out, or why not."""

    command: Computed | None
    refusal: Reason = Reason.NONE
    outcome: Outcome = Outcome.PUBLISHED
    detail: str = ""


_PASSED, _CLAMPED, _ = Verdict


class CommandCheck:
    """Asks the guard about every command; counts and logs what it clamps and refuses.

    ``verdict`` and ``limits`` are those of the last command in this tick; NO_VALUE and 0 without.
    """

    def __init__(self, guard: Guard, timeout_s: float, logger: Logger) -> None:
        self.clamped = 0
        self.refused = 0
        self.sequence = 0
        self.skip()
        self._guard = guard
        self._timeout_s = timeout_s
        self._logger = logger

    def skip(self) -> None:
        """Note a tick in which the guard is asked about no command."""
        self.verdict: int = NO_VALUE
        self.limits = 0

    def check(
        self, command: Computed, now: float, speed: float, steering: float, engaged: bool
    ) -> Checked:
        """Judge a command at ``now`` [s, monotonic]; speed [m/s] and steering [rad] as measured."""
        self.sequence += 1
        stamp, other, *values, _ = command
        oldest = other if other < stamp else stamp
        proposal = Proposal(now, oldest, self.sequence, *values)
        decision = self._guard.check(proposal, speed, steering, engaged)
        self.verdict, self.limits = decision.verdict, decision.limits
        if decision.verdict is _PASSED:
            return Checked(command)
        if decision.verdict is _CLAMPED:
            return self._clamp(command, decision[2:])
        return self._refuse(command, now - self._timeout_s)

    def take_back(self) -> None:
        """Note that the last command was not sent: its predecessor is that of the next one."""
        self._guard.take_back()

    def forget(self) -> None:
        """Note that nothing was sent: the next command has no predecessor."""
        self._guard.forget()

    def _clamp(self, command: Computed, values: tuple[float, ...]) -> Checked:
        self.clamped += 1
        names = self._names()
        self._logger.warning("the guard clamped a command: %s", names, throttled=True, site=names)
        return Checked(command.with_values(values))

    def _refuse(self, command: Computed, oldest: float) -> Checked:
        self.refused += 1
        names = self._names()
        self._logger.error("the guard refused a command: %s", names, throttled=True, site=names)
        if self.limits & Limit.STALE and (side := command.stale_side(oldest)):
            return Checked(None, Reason.COMMAND_STALE, Outcome.STALE, side)
        outcome = Outcome.NOT_FINITE if self.limits & Limit.NOT_FINITE else Outcome.REFUSED
        return Checked(None, Reason.COMMAND_REFUSED, outcome, names)

    def _names(self) -> str:
        names = [str(bit.name).lower().replace("_", " ") for bit in Limit(self.limits)]
        return ", ".join(names)
