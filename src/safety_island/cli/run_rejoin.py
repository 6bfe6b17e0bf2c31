# SPDX-License-Identifier: Apache-2.0
"""When ``island run`` may join its domain anew, and what it keeps."""

from __future__ import annotations

import os

from safety_island.cli.start_again import must_rejoin, start_again
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.node import ControllerNode, TickReport

_LATCHED = "SAFETY_ISLAND_LATCHED"
"""Environment variable: number of the Reason that an island was latched for before."""
_SENDS_NOTHING = (State.INIT, State.SILENT)


class IslandRejoin:
    """An observer of the ticks: ends the run when the domain must be joined anew.

    It waits until the island sends nothing. What has lost its network comes to that by itself: its
    inputs are stale, and a vehicle that hears only CAN is stopped first.
    """

    def __init__(self, node: ControllerNode) -> None:
        self.is_due = False
        self._latched = Reason.NONE
        self._node = node
        if (number := os.environ.pop(_LATCHED, "")).isdecimal():
            node.life_cycle.latch(Reason(int(number)))

    def __call__(self, report: TickReport) -> None:
        """Look after a tick."""
        if not self.is_due and must_rejoin() and report.life.state in _SENDS_NOTHING:
            self.is_due, self._latched = True, report.life.cause
            self._node.stop()

    def start_again(self) -> None:
        """Replace this process; an island that was latched stays so."""
        if self._latched is not Reason.NONE:
            os.environ[_LATCHED] = str(int(self._latched))
        start_again()
