# SPDX-License-Identifier: Apache-2.0
"""A command on its way out: to every output, and taken back when silence follows."""

from __future__ import annotations

from collections.abc import Sequence
from struct import Struct

import numpy as np

from safety_island.command.control_message import write_control
from safety_island.command.encoding import Encoding
from safety_island.control.records import COMMAND
from safety_island.kernel.records import Records
from safety_island.messages.fixed import FixedMessage, layout, reader
from safety_island.messages.outputs import CONTROL
from safety_island.messages.wire import Time
from safety_island.node.command import Computed
from safety_island.node.outgoing import OutgoingControl
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
        self.command: OutgoingControl | None = None
        self.record: Records = np.zeros(1, COMMAND)
        """The last command, stamps on the monotonic clock; always the same memory."""
        self.foreign_frames = 0
        """What somebody else sends as commands on the outputs, as of the last ``listen``."""
        self._clock = clock
        self._logger = logger
        self._message = FixedMessage(CONTROL)
        self._pack = Struct(f"={layout(COMMAND)}").pack_into
        self._memory = self.record.view(np.uint8).data
        self._stamp = reader(self._message.body["stamp"], "sec", "nanosec")
        self._write = write_control.bind(self.record, self._message.body)

    def send(self, result: Computed) -> bool:
        """Send a command; whether it went out on any output."""
        self.command = command = self._encode(result)
        if command is None:
            self._logger.error("not sent: the stamp fits no message", throttled=True)
            return False
        stamp_ns = Time(*self._stamp()).nanoseconds
        went_out = False
        for output in self.outputs:
            try:
                went_out = output.send(command, stamp_ns) or went_out
            except MemoryError:
                raise
            except Exception as error:  # against its contract
                self._failed(output, error)
        return went_out

    def _encode(self, result: Computed) -> OutgoingControl | None:
        """Make the message of a command; None when a stamp of it does not fit."""
        self._pack(self._memory, 0, *result)
        offset_ns = self._clock.wall_ns() - self._clock.monotonic_ns()
        if self._write(offset_ns) != Encoding.DONE:
            return None
        return OutgoingControl(self._message.to_bytes())

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
