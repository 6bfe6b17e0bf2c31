"""Both controllers of one tick, timed, with what they could not do."""

from __future__ import annotations

from typing import NamedTuple

from safety_island.control.status import MpcStatus
from safety_island.node.command import Computed, computed
from safety_island.node.follower import Follower
from safety_island.node.report import describe
from safety_island.platform.interfaces import Clock, Logger


class Ran(NamedTuple):
    """What came of the controllers."""

    command: Computed | None
    """None when there is no new command."""
    fault: str = ""
    """The exception that ended them: a fault of the program."""
    unsolved: bool = False
    """The MPC found no steering angle, and the last one is held."""


NO_COMMAND = Ran(None)


class Controllers:
    """Lateral, then longitudinal, then the hand-over; ``spent_ns`` is what each took [ns]."""

    def __init__(self, follower: Follower, clock: Clock, logger: Logger) -> None:
        self.spent_ns = (0, 0)
        self._follower = follower
        self._clock = clock
        self._logger = logger
        self._stamp = follower.command["stamp"]
        """Of the lateral part: the kernels leave it to their caller."""

    def run(self, now: float) -> Ran:
        """Run both at ``now`` [s, monotonic]; an exception but MemoryError is a value."""
        try:
            return self._run(now)
        except MemoryError:
            raise
        except Exception as error:  # a tick may fail, the process may not
            fault = describe(error)
            self._logger.error("the controllers failed: %s", fault, throttled=True)
            return Ran(None, fault)

    def _run(self, now: float) -> Ran:
        if not self._follower.is_ready():
            return NO_COMMAND
        begin_ns = self._clock.monotonic_ns()
        status = self._follower.run_lateral(now)
        if status == MpcStatus.NO_REFERENCE:
            return NO_COMMAND
        self._stamp[0] = now
        middle_ns = self._clock.monotonic_ns()
        if self._follower.run_longitudinal(now) < 0:
            return NO_COMMAND
        self.spent_ns = (middle_ns - begin_ns, self._clock.monotonic_ns() - middle_ns)
        self._follower.sync()
        is_solved = status == MpcStatus.SOLVED
        if not is_solved:
            reason = MpcStatus(status).name.lower().replace("_", " ")
            self._logger.warning("no new steering angle: %s", reason, throttled=True, site="mpc")
        return Ran(computed(self._follower.command), "", not is_solved)
