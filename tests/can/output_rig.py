# SPDX-License-Identifier: Apache-2.0
"""CAN output on the mock bus, on a clock that stands still between ticks."""

from __future__ import annotations

from itertools import islice

from safety_island.can.command import Cause, Command
from safety_island.can.decoder import Decoded, decode
from safety_island.can.link import DirectLink
from safety_island.can.mock import MockBus
from safety_island.can.output import CanOutput
from safety_island.command.mode import OutputMode
from safety_island.platform.interfaces import CanFrame
from tests.can.rig import REFERENCE, FakeClock, LogLines

PERIOD_S = 0.15


class OutputRig:
    """An output, its bus, and ticks."""

    def __init__(self, mode: OutputMode = OutputMode.DDS_AND_CAN) -> None:
        self.clock = FakeClock()
        self.log = LogLines()
        self.bus = MockBus()
        self.bus.open()
        self.recorded: list[tuple[int, tuple[CanFrame, ...]]] = []
        self.output = CanOutput(
            mode,
            DirectLink(self.bus, self.clock),
            PERIOD_S / 10,
            self.clock,
            self.log,
            lambda stamp_ns, frames: self.recorded.append((stamp_ns, tuple(frames))),
        )

    def tick(self, command: Command = REFERENCE, count: int = 1) -> list[Cause | None]:
        """Send a command in each of some periods; return what became of them."""
        causes = []
        for _ in range(count):
            was_sent = self.output.send(command, self.clock.now_ns)
            assert self.output.last is not None
            assert was_sent is (self.output.last.cause is None)
            causes.append(self.output.last.cause)
            self.clock.advance(PERIOD_S)
        return causes

    def heard(self) -> list[Decoded]:
        """Return the commands on the bus, which must be whole triples and nothing else."""
        frames = iter(self.bus.frames)
        commands = []
        while triple := list(islice(frames, 3)):
            found = decode(triple)
            assert isinstance(found, Decoded), found
            commands.append(found)
        return commands
