# SPDX-License-Identifier: Apache-2.0
"""Where a command goes. Each output takes the same command; one that fails stops no other."""

from __future__ import annotations

from typing import Protocol

from safety_island.dds.topics import TopicEntry
from safety_island.kernel.cdr import NANOSECONDS
from safety_island.messages.outputs import encode_float64_stamped
from safety_island.node.outgoing import OutgoingControl
from safety_island.node.transport import Publisher
from safety_island.platform.interfaces import Logger


class Output(Protocol):
    """One way for commands to leave the island."""

    name: str
    failed: int
    """Commands that it could not take."""

    def send(self, command: OutgoingControl, stamp_ns: int) -> bool:
        """Send a command with its wall-clock stamp [ns]; False when it did not go out.

        Never waits longer than a tenth of a period, never raises, and counts and logs why.
        """

    def listen(self) -> int:
        """Count what somebody else sends here as commands; called in every tick, never waits."""

    def close(self) -> None:
        """Give back what the output holds."""


class TopicWriter:
    """A publisher whose failures are counted and logged."""

    def __init__(self, topic: TopicEntry, publisher: Publisher, logger: Logger) -> None:
        self.name = topic.name
        self.failed = 0
        self._publisher = publisher
        self._logger = logger

    def write(self, data: bytes) -> bool:
        """Send one message; False when it did not go out."""
        try:
            if self._publisher.write(data):
                return True
            problem = self._publisher.last_error
        except OSError as error:  # no descriptor, no buffer: the topic's loss, not the tick's
            problem = str(error)
        self.failed += 1
        self._logger.error("not sent: %s", problem, throttled=True, site=self.name)
        return False

    def close(self) -> None:
        """The transport closes its publishers."""


class ControlTopic(TopicWriter):
    """Publishes ``autoware_control_msgs/msg/Control``.

    The topic keeps its last message for those who come later. A bridge that is started while the
    island is silent would hand it on as if it were new, so silence takes it back.
    """

    _stands = False

    def send(self, command: OutgoingControl, stamp_ns: int) -> bool:
        """Publish a command; its stamps are in it."""
        self._stands = True
        return self.write(command.message)

    def listen(self) -> int:
        """Other publishers are found by discovery (Identity)."""
        return 0

    def withdraw(self) -> None:
        """Take back the last command, once."""
        if self._stands:
            self._stands = False
            self._publisher.withdraw()


class ProcessingTimes:
    """Publishes how long each controller took, as ``Float64Stamped`` in milliseconds."""

    def __init__(self, lateral: TopicWriter, longitudinal: TopicWriter) -> None:
        self.writers = (lateral, longitudinal)

    def send(self, wall_ns: int, spent_ns: tuple[int, int]) -> None:
        """Publish both durations [ns]; a failure is no reason to stop."""
        stamp = divmod(wall_ns, NANOSECONDS)
        (lateral, longitudinal), (lateral_ns, longitudinal_ns) = self.writers, spent_ns
        lateral.write(encode_float64_stamped(stamp, lateral_ns / 1e6))
        longitudinal.write(encode_float64_stamped(stamp, longitudinal_ns / 1e6))
