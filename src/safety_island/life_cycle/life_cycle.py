# SPDX-License-Identifier: Apache-2.0
"""The life cycle as Python sees it: classes over the kernels and their memory, without a rule."""

from __future__ import annotations

from functools import cache
from struct import Struct

import numpy as np

from safety_island.kernel.records import Records, cells
from safety_island.life_cycle.facts import Facts
from safety_island.life_cycle.island_watch import (
    islands_blocked,
    islands_look_around,
    islands_newcomer,
    islands_update,
)
from safety_island.life_cycle.limits import MAX_PUBLISHERS
from safety_island.life_cycle.params import LifeCycleParams
from safety_island.life_cycle.ramp import Motion
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.records import (
    FACTS,
    FACTS_COLUMNS,
    GUID,
    ISLANDS,
    LIFE_STATE,
    MOTION,
    PUBLISHERS,
    pack_life_params,
)
from safety_island.life_cycle.state import LifeFlag, State
from safety_island.life_cycle.tick import (
    life_begin,
    life_fault,
    life_flags,
    life_judge,
    life_motion,
    life_sent,
    life_start,
)
from safety_island.life_cycle.transition import Life

_FORMATS = {"i8": "q", "f8": "d", "?": "?"}
_FACTS = Struct("".join(_FORMATS[kind] for _, kind in FACTS_COLUMNS))
_LIFE, _MOTION = Struct("3q"), Struct("4d")
_CONTROLS, _ARMED, _MUST_STOP = map(int, LifeFlag)


@cache
def as_life(state: int, reason: int, cause: int) -> Life:
    """Return the numbers of a LIFE record as the enumerations that they stand for."""
    return Life(State(state), Reason(reason), Reason(cause))


class Overrun:
    """Whether the ticks come in time, as the memory says (OVERRUN of shape (1,))."""

    def __init__(self, memory: Records) -> None:
        cell = cells(memory)
        self._in_row, self._degraded, self._over = cell["in_row"], cell["degraded"], cell["over"]

    @property
    def in_row(self) -> int:
        """Late ticks in a row."""
        return self._in_row[0]  # type: ignore[no-any-return]

    @property
    def degraded(self) -> bool:
        """Ticks in a row were late, or the mean period is too long."""
        return self._degraded[0]  # type: ignore[no-any-return]

    @property
    def over(self) -> bool:
        """That has gone on for too many ticks, and the output must end."""
        return self._over[0]  # type: ignore[no-any-return]


class IslandWatch:
    """Publishers of the control command that are not ours; times in s, monotonic."""

    def __init__(self, joined_at: float, discovery_s: float, memory: Records | None = None) -> None:
        """``memory``: ISLANDS of shape (1,), all zero; it is looked around for ``discovery_s``."""
        memory = np.zeros(1, ISLANDS) if memory is None else memory
        memory["ready_at"] = joined_at + discovery_s
        self._seen: Records = np.zeros(1, PUBLISHERS)
        self._others = memory["others"]
        self._count = cells(self._others)["n"]
        self._update = islands_update.bind(memory, self._seen)
        self._newcomer = islands_newcomer.bind(memory)
        self._look_around = islands_look_around.bind(memory)
        self._blocked = islands_blocked.bind(memory)

    def update(self, others: frozenset[bytes] | set[bytes], now: float) -> None:
        """Note which other publishers live now (GUIDs)."""
        listed = sorted(others)[:MAX_PUBLISHERS]
        self._seen["n"] = len(others)
        self._seen["guids"][0, : len(listed)] = np.frombuffer(b"".join(listed), GUID)
        self._update(now)

    @property
    def count(self) -> int:
        """Other publishers that live now."""
        return self._count[0]  # type: ignore[no-any-return]

    @property
    def others(self) -> frozenset[bytes]:
        """GUIDs of those that live now, as far as the memory holds them."""
        held = self._others["guids"][0, : self.count]
        return frozenset(guid.tobytes() for guid in held)

    def looks_around(self, now: float) -> bool:
        """Whether it is too early to say that there is no other."""
        return bool(self._look_around(now))

    @property
    def is_newcomer(self) -> bool:
        """Whether one that was there before still lives."""
        return bool(self._newcomer())

    def blocked(self, flaps: bool, keeps_first: bool, now: float) -> Reason:
        """Why nothing may be sent because of other publishers, NONE when it may.

        ``flaps``: they came and went too often; ``keeps_first``: later ones are let be.
        """
        return Reason(self._blocked(flaps, keeps_first, now))


class LifeCycle:
    """State, reason and memory of the island; told the time [s, monotonic], reads no clock.

    ``has_ramp``: the vehicle hears only CAN, and nobody brakes it when commands stop. ``memory``
    (LIFE_STATE of shape (1,)) is all that it remembers.
    """

    def __init__(self, params: LifeCycleParams, period_s: float, has_ramp: bool) -> None:
        packed = pack_life_params(params, period_s, has_ramp)
        self.memory: Records = np.zeros(1, LIFE_STATE)
        facts: Records = np.zeros(1, FACTS)
        command: Records = np.zeros(1, MOTION)
        life_start.bind(packed, self.memory)()
        self.overrun = Overrun(self.memory["overrun"])
        self._life, self._facts = self.memory.view(np.uint8).data, facts.view(np.uint8).data
        self._command = command.view(np.uint8).data
        self._begin = life_begin.bind(packed, self.memory)
        self._judge = life_judge.bind(packed, self.memory, facts)
        self._fault = life_fault.bind(packed, self.memory)
        self._motion = life_motion.bind(packed, self.memory, command)
        self._sent = life_sent.bind(self.memory, command)
        self._flags = life_flags.bind(packed, self.memory)

    @property
    def life(self) -> Life:
        """State, reason and latched cause."""
        return as_life(*_LIFE.unpack_from(self._life))

    @property
    def state(self) -> State:
        """The present state."""
        return self.life.state

    @property
    def controls(self) -> bool:
        """Whether the controllers may count on being followed."""
        return bool(self._flags() & _CONTROLS)

    @property
    def is_armed(self) -> bool:
        """Whether the vehicle is under control, or may be again without being engaged anew."""
        return bool(self._flags() & _ARMED)

    @property
    def must_stop(self) -> bool:
        """Whether commands may not just end: the vehicle hears only CAN, and is not at rest."""
        return bool(self._flags() & _MUST_STOP)

    def latch(self, cause: Reason) -> None:
        """Begin in silence, as the process did that this one takes the place of."""
        _LIFE.pack_into(self._life, 0, State.SILENT, cause, cause)

    def begin(self, now: float, slept_s: float, skipped: int) -> bool:
        """Begin a tick; True when the process stood still, and everything begins anew.

        ``slept_s`` [s] is how long the machine has slept in all, ``skipped`` counts missed ticks.
        """
        return bool(self._begin(now, slept_s, skipped))

    def judge(self, facts: Facts, now: float) -> Life:
        """Take the facts of a tick; return the state that decides what it sends."""
        _FACTS.pack_into(self._facts, 0, *facts)
        self._judge(now)
        return self.life

    def fault(self) -> Life:
        """Note a tick that ended with an exception; too many end the output as other causes do."""
        self._fault()
        return self.life

    def motion(self) -> Motion | None:
        """Return the command that HOLD and STOP send in place of the controllers'."""
        return Motion._make(_MOTION.unpack_from(self._command)) if self._motion() else None

    def sent(self, motion: Motion, went_out: bool, now: float) -> None:
        """Note a command of the controllers that went out, or that no output could take."""
        _MOTION.pack_into(self._command, 0, *motion)
        self._sent(went_out, now)
