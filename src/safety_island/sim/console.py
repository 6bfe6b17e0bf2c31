# SPDX-License-Identifier: Apache-2.0
"""Lines on standard input that act on the main compute while it drives: mode, faults, the end."""

from __future__ import annotations

import os
import select
from collections.abc import Callable
from typing import TYPE_CHECKING

from safety_island.dds.topics import ACCELERATION, ODOMETRY, STEERING, TRAJECTORY

if TYPE_CHECKING:
    from safety_island.sim.main_compute import MainCompute

FREEZABLE = tuple(topic.key for topic in (TRAJECTORY, ODOMETRY, STEERING, ACCELERATION))
"""Topics that can be frozen, by their keys."""

JUMP_M = 6.0
"""How far [m] a trajectory jumps: farther than any planner would and the controllers follow."""

WORDS = "engage, disengage, stay, nan, number, jump, return, freeze TOPIC, thaw TOPIC, end"
"""What ``Console`` understands."""


class Console:
    """Reads commands, one a line, without ever waiting for them.

    ``engage`` and ``disengage`` autonomous mode; ``stay`` in it when commands stop coming;
    ``nan`` and ``number``: the position of the odometry; ``jump`` and ``return``: the trajectory,
    by JUMP_M to the left; ``freeze`` and ``thaw`` a topic; ``end`` the drive. The end of the input
    ends the program.
    """

    def __init__(self, say: Callable[[str], None], descriptor: int = 0) -> None:
        self.has_ended = False
        """Whether the drive was asked to end."""
        self.is_closed = False
        """Whether the input has come to its end."""
        self._say, self._descriptor, self._rest = say, descriptor, b""
        self._poll = select.poll()
        self._poll.register(descriptor, select.POLLIN)

    def poll(self, main_compute: MainCompute) -> None:
        """Obey the lines that have come."""
        while not self.is_closed and self._poll.poll(0):
            data = os.read(self._descriptor, 4096)
            if not data:
                self.is_closed = True
                return
            *lines, self._rest = (self._rest + data).split(b"\n")
            for line in lines:
                self._obey(main_compute, line.decode(errors="replace").split())

    def _obey(self, main_compute: MainCompute, words: list[str]) -> None:
        match words:
            case ["engage"]:
                main_compute.world.engage()
            case ["disengage"]:
                main_compute.world.disengage()
            case ["stay"]:
                main_compute.world.stay_engaged()
            case ["nan" | "number" as word]:
                main_compute.nan_odometry = word == "nan"
            case ["jump"]:
                main_compute.trajectory_offset = JUMP_M
            case ["return"]:
                main_compute.trajectory_offset = 0.0
            case ["freeze", key] if key in FREEZABLE:
                main_compute.frozen.add(key)
            case ["thaw", key] if key in FREEZABLE:
                main_compute.frozen.discard(key)
            case ["end"]:
                self.has_ended = True
            case []:
                pass
            case _:
                known = f"{WORDS}; topics: {', '.join(FREEZABLE)}"
                self._say(f"unknown command '{' '.join(words)}'; there are: {known}")
