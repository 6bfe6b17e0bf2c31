# SPDX-License-Identifier: Apache-2.0
"""The way of a command: guard, life cycle, outputs; and what goes out in its place."""

from __future__ import annotations

from safety_island.life_cycle.life_cycle import LifeCycle
from safety_island.life_cycle.ramp import Motion
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.node.command import Computed, substitute
from safety_island.node.command_check import Checked, CommandCheck
from safety_island.node.controllers import Ran
from safety_island.node.input_set import InputSet
from safety_island.node.report import Outcome, describe
from safety_island.node.sender import CommandSender
from safety_island.platform.interfaces import Logger

_PUBLISHED = Outcome.PUBLISHED
_SENDS = (State.READY, State.ACTIVE)
_OUTCOMES = {
    Reason.WAITING_FOR_INPUT: Outcome.WAITING_FOR_INPUT,
    Reason.NO_TRAJECTORY: Outcome.NOT_READY,
}
"""What a tick without a command is called; FORBIDDEN for every other reason."""


class CommandPath:
    """Takes commands from the controllers to the outputs. Times in s, monotonic."""

    def __init__(
        self,
        check: CommandCheck,
        life_cycle: LifeCycle,
        sender: CommandSender,
        inputs: InputSet,
        logger: Logger,
    ) -> None:
        self._guard, self._life_cycle, self._sender = check, life_cycle, sender
        self._inputs, self._logger = inputs, logger

    def check(self, ran: Ran, now: float, engaged: bool) -> Checked:
        """Ask the guard about what the controllers computed."""
        if ran.command is None:
            self._guard.skip()
            return Checked(None, outcome=Outcome.FAULT, detail=ran.fault)
        speed, steering = self._inputs.speed(), self._inputs.steering()
        return self._guard.check(ran.command, now, speed, steering, engaged)

    def send(self, checked: Checked, now: float) -> tuple[Outcome, str]:
        """Send what the state lets out."""
        life = self._life_cycle.life
        if life.state in _SENDS and checked.command is not None:
            sent = self._publish(checked.command, _PUBLISHED)
            motion = tuple.__new__(Motion, checked.command[2:6])
            self._life_cycle.sent(motion, sent[0] is _PUBLISHED, now)
            return sent
        if (substituted := self._life_cycle.motion()) is not None:
            if checked.command is not None:
                self._guard.take_back()
            return self._substitute(substituted, now)
        if life.state in _SENDS:  # a single tick; the next command has the same predecessor
            return checked.outcome, checked.detail
        self._guard.forget()
        return _OUTCOMES.get(life.reason, Outcome.FORBIDDEN), self._detail(life.reason)

    def carry_on(self, now: float) -> None:
        """End a tick that an exception has ended; a stop goes on, whatever fails in it."""
        if self._sender.command is not None or (motion := self._life_cycle.motion()) is None:
            return
        self._guard.forget()  # who knows what it has seen in this tick
        try:
            self._substitute(motion, now)
        except MemoryError:
            raise
        except Exception as error:
            self._logger.error("the stop failed: %s", describe(error), throttled=True)

    def _substitute(self, motion: Motion, now: float) -> tuple[Outcome, str]:
        """Send a command of the life cycle; the guard judges it like any other."""
        speed, steering = self._inputs.speed(), self._inputs.steering()
        checked = self._guard.check(substitute(motion, now), now, speed, steering, False)
        if checked.command is None:
            return checked.outcome, checked.detail
        return self._publish(checked.command, Outcome.SUBSTITUTED)

    def _publish(self, result: Computed, sent: Outcome) -> tuple[Outcome, str]:
        """Send a command, and say how that ended."""
        if self._sender.send(result):
            return sent, ""
        return Outcome.OUTPUT_FAILED, ", ".join(output.name for output in self._sender.outputs)

    def _detail(self, reason: Reason) -> str:
        if reason is Reason.WAITING_FOR_INPUT:
            return ", ".join(self._inputs.missing())
        return reason.name.lower().replace("_", " ")
