# SPDX-License-Identifier: Apache-2.0
"""A command on its way out: to every output, and taken back when silence follows."""

from __future__ import annotations

from collections.abc import Sequence

from safety_island.kernel.cdr import NANOSECONDS
from safety_island.messages.outputs import Control
from safety_island.node.command import Computed
from safety_island.node.outputs import ControlTopic, Output
from safety_island.node.report import describe
from safety_island.platform.interfaces import Clock, Logger


class CommandSender:
    """Gives each command to all ``outputs``; what happens in one stops no other.

    ``command`` is that of the present tick, also when no output took it; None when there is none.
    """

    def __init__(self, clock: Clock, logger: Logger) -> None:
        self.outputs: Sequence[Output] = ()
        self.topics: list[ControlTopic] = []
        """Those whose last command stands until it is taken back."""
        self.command: Control | None = None
        self.foreign_frames = 0
        """What somebody else sends as commands on the outputs, as of the last ``listen``."""
        self._clock = clock
        self._logger = logger

    def send(self, result: Computed) -> bool:
        """Send a command; whether it went out on any output."""
        offset_ns = self._clock.wall_ns() - self._clock.monotonic_ns()
        self.command = command = result.to_control(offset_ns)
        sec, nanosec = command.stamp
        stamp_ns = sec * NANOSECONDS + nanosec
        went_out = False
        for output in self.outputs:
            try:
                went_out = output.send(command, stamp_ns) or went_out
            except MemoryError:
                raise
            except Exception as error:  # against its contract
                self._failed(output, error)
        return went_out

    def listen(self) -> None:
        """Look whether somebody else sends commands, also while the island sends none."""
        frames = 0
        for output in self.outputs:
            try:
                frames += output.listen()
            except MemoryError:
                raise
            except Exception as error:  # against its contract
                self._failed(output, error)
        self.foreign_frames = frames

    def _failed(self, output: Output, error: Exception) -> None:
        output.failed += 1
        self._logger.error("output %s failed: %s", output.name, describe(error), throttled=True)

    def withdraw(self) -> None:
        """Take back what was said last: silence must not leave it standing."""
        for topic in self.topics:
            topic.withdraw()

    def close(self) -> None:
        """Close the outputs."""
        for output in self.outputs:
            output.close()
