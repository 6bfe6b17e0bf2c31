# SPDX-License-Identifier: Apache-2.0
"""Kernels of the life cycle over memory of their own, in the words of Python."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from safety_island.kernel.kernel import JIT, kernel
from safety_island.life_cycle import failures, overrun, ramp, transition
from safety_island.life_cycle.life_cycle import as_life
from safety_island.life_cycle.params import LifeCycleParams
from safety_island.life_cycle.ramp import Motion
from safety_island.life_cycle.records import MOTION, OVERRUN, RAMP, STREAK, pack_life_params
from safety_island.life_cycle.transition import Conditions, Life


def next_life(life: Life, now: Conditions) -> Life:
    """The life that follows."""
    return as_life(*map(int, transition.next_life(_numbers(life), _numbers(now))))


def table_of(conditions: Sequence[Conditions]) -> Any:
    """Return conditions as numbers, for ``successors``."""
    numbers = np.array(conditions, np.int64)
    return numbers if JIT else numbers.tolist()


def successors(life: Life, table: Any) -> set[Life]:
    """Every life that can follow under the conditions of a table, found in one call."""
    found = np.zeros(len(table), np.int64)
    _follow(_numbers(life), table, found)
    return {as_life(code // 10_000, code // 100 % 100, code % 100) for code in set(found.tolist())}


@kernel
def _follow(life: Any, conditions: Any, found: Any) -> None:
    for i in range(len(conditions)):
        c = conditions[i]
        arm, has_ramp, hold, over, path = c[3] != 0, c[4] != 0, c[5] != 0, c[6] != 0, c[7] != 0
        now = Conditions(c[0], c[1], c[2], arm, has_ramp, hold, over, path)
        after = transition.next_life(life, now)
        found[i] = after.state * 10_000 + after.reason * 100 + after.cause


def _numbers(values: NamedTuple) -> Any:
    """The same tuple with numbers in place of enumerations."""
    found = (value if isinstance(value, bool) else int(value) for value in values)
    return values._make(found)


class Memory:
    """A record whose fields read as attributes, as Python numbers."""

    def __init__(self, dtype: Any) -> None:
        self.record = np.zeros(1, dtype)[0]

    def __getattr__(self, name: str) -> Any:
        return self.record[name].item()


class Streak(Memory):
    """Failures in a row."""

    def __init__(self) -> None:
        super().__init__(STREAK)

    def note(self, failed: bool, now: float) -> None:
        failures.note(self.record, failed, now)

    def lasts_s(self, now: float) -> float:
        return float(failures.lasts_s(self.record, now))


class Overrun(Memory):
    """Whether ticks come in time."""

    def __init__(self, params: LifeCycleParams, period_s: float) -> None:
        super().__init__(OVERRUN)
        self._params = pack_life_params(params, period_s, False)[0]

    def tick(self, now: float, skipped: int) -> None:
        overrun.note_tick(self._params, self.record, now, skipped)

    def forget(self) -> None:
        overrun.forget_overrun(self.record)


class StopRamp(Memory):
    """The ramp from a last command and speed [m/s]."""

    def __init__(self, params: LifeCycleParams, last: Motion, speed: float) -> None:
        super().__init__(RAMP)
        self._params = pack_life_params(params, 1.0, True)[0]
        ramp.begin_ramp(self.record, np.array([tuple(last)], MOTION)[0], speed)

    def step(self, dt: float) -> Motion:
        out = np.zeros(1, MOTION)[0]
        ramp.step_ramp(self._params, self.record, dt, out)
        return Motion(*out.item())
