# SPDX-License-Identifier: Apache-2.0
"""A life cycle that is told facts, tick by tick."""

from __future__ import annotations

from safety_island.life_cycle.facts import Facts
from safety_island.life_cycle.life_cycle import LifeCycle
from safety_island.life_cycle.ramp import Motion
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.life_cycle.transition import Life
from tests.life_cycle.parameters import PARAMETERS

T = 0.125
MANUAL = Reason.NOT_AUTONOMOUS
GONE = Reason.MODE_WRITER_GONE
STALE = Reason.INPUT_STALE
WELL = Life(State.ACTIVE, Reason.NONE)
SENT = Motion(0.25, 0.5, 2.0, -0.5)
HELD = SENT._replace(rate=0.0)


class Island:
    """Ticks every T; a command goes out in READY and ACTIVE."""

    def __init__(self, has_ramp: bool = False, **changes: float) -> None:
        params = PARAMETERS.__class__(**(vars(PARAMETERS) | changes))
        self.life_cycle = LifeCycle(params, T, has_ramp)
        self.now = 100.0
        self.slept_s = 0.0
        self.went_out = True

    def tick(
        self,
        blocked: Reason = Reason.NONE,
        disengaged: Reason = Reason.NONE,
        speed: float = 2.0,
        skipped: int = 0,
        refused: Reason = Reason.NONE,
        **facts: bool,
    ) -> Life:
        self.begin(skipped=skipped)
        found = Facts(blocked, disengaged, speed, refused=refused, **facts)
        life = self.life_cycle.judge(found, self.now)
        if life.state in (State.READY, State.ACTIVE):
            self.life_cycle.sent(SENT, self.went_out, self.now)
        return life

    def begin(self, after_s: float = T, skipped: int = 0) -> bool:
        self.now += after_s
        return self.life_cycle.begin(self.now, self.slept_s, skipped)

    def engage(self) -> Island:
        """Drive."""
        self.tick(disengaged=MANUAL)
        assert self.tick() == WELL
        return self

    @property
    def life(self) -> Life:
        return self.life_cycle.life


def silent(reason: Reason, cause: Reason | None = None) -> Life:
    return Life(State.SILENT, reason, reason if cause is None else cause)
