# SPDX-License-Identifier: Apache-2.0
"""Both controllers of one tick, timed, with what they could not do."""

from __future__ import annotations

from typing import NamedTuple

from safety_island.control.status import MpcStatus
from safety_island.messages.fixed import reader
from safety_island.node.command import Computed
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
    off_path: bool = False
    """Because the trajectory leads where the vehicle is not."""


NO_COMMAND = Ran(None)
_NO_REFERENCE, _SOLVED = MpcStatus.NO_REFERENCE, MpcStatus.SOLVED
_OFF_PATH = (MpcStatus.TOO_FAR, MpcStatus.YAW_ERROR_TOO_LARGE)


class Controllers:
    """Lateral, then longitudinal, then the hand-over.

    ``have_run`` tells whether both came to their end in this tick, ``spent_ns`` what each took
    [ns].
    """

    def __init__(self, follower: Follower, clock: Clock, logger: Logger) -> None:
        self.begin()
        self._follower = follower
        self._clock = clock
        self._logger = logger
        self._stamp = follower.command["stamp"]
        """Of the lateral part: the kernels leave it to their caller."""
        self._command = reader(follower.command, *Computed._fields)

    def begin(self) -> None:
        """Begin a tick: neither has run."""
        self.have_run, self.spent_ns = False, (0, 0)

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
        follower, monotonic_ns = self._follower, self._clock.monotonic_ns
        if not follower.is_ready():
            return NO_COMMAND
        begin_ns = monotonic_ns()
        status = follower.run_lateral(now)
        if status is _NO_REFERENCE:
            return NO_COMMAND
        self._stamp[0] = now
        middle_ns = monotonic_ns()
        if follower.run_longitudinal(now) < 0:
            return NO_COMMAND
        self.spent_ns = (middle_ns - begin_ns, monotonic_ns() - middle_ns)
        self.have_run = True
        follower.sync()
        command = tuple.__new__(Computed, self._command())
        if status is _SOLVED:
            return tuple.__new__(Ran, (command, "", False, False))
        reason = status.name.lower().replace("_", " ")
        self._logger.warning("no new steering angle: %s", reason, throttled=True, site="mpc")
        return Ran(command, unsolved=True, off_path=status in _OFF_PATH)
