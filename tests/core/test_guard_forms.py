# SPDX-License-Identifier: Apache-2.0
"""Compiled and as plain Python the guard decides the same, bit for bit, from any memory on."""

from __future__ import annotations

import random
from math import inf, nan

import numpy as np
import pytest

from safety_island.core.guard import (
    GUARD_DECISION,
    GUARD_PARAMS,
    GUARD_PROPOSAL,
    GUARD_STATE,
    Guard,
    Proposal,
    guard_command,
    guard_forget,
    guard_take_back,
    pack_guard,
)
from safety_island.kernel import kernel
from safety_island.kernel.kernel import Entry
from safety_island.kernel.records import Records
from safety_island.params import load_set

ENTRIES = {entry.name: entry for entry in (guard_command, guard_take_back, guard_forget)}
HOSTILE = (nan, inf, -inf, 0.0, -0.0, 1.7e308, -1.7e308, 5e-324, 1e-160)
CHECKS = 300
needs_compiled = pytest.mark.skipif(
    not kernel.JIT and kernel.LIBRARY is None, reason="kernels are plain Python in this process"
)


class Form:
    """A guard with its records, whose kernels are plain Python or what ``prepare`` gives."""

    def __init__(self, name: str, is_plain: bool) -> None:
        parameters = load_set(name)
        wheel_base = parameters.vehicle.wheel_base
        self.params = pack_guard(parameters.guard, wheel_base, 0.5)
        self.state: Records = np.zeros(1, GUARD_STATE)
        self.decision: Records = np.zeros(1, GUARD_DECISION)
        self.is_plain = is_plain

    def run(self, entry: Entry, *records: Records) -> int:
        """Call an entry in this form."""
        if self.is_plain:
            return entry.python(*records)
        entry.prepare()
        return entry.call(*records)

    def apply(self, step: tuple[str, Records | None]) -> bytes:
        """Do one thing to the guard; return all bytes that it may have changed."""
        name, proposal = step
        if proposal is None:
            result = self.run(ENTRIES[name], self.state)
        else:
            result = self.run(ENTRIES[name], self.params, self.state, proposal, self.decision)
        return bytes([result]) + self.state.tobytes() + self.decision.tobytes()


def steps(seed: int) -> list[tuple[str, Records | None]]:
    """A drive with jumps, hostile numbers, commands that were not sent, and silences."""
    lot = random.Random(seed)
    found: list[tuple[str, Records | None]] = []
    now, angle = 10.0, 0.0

    def hostile(value: float) -> float:
        return lot.choice(HOSTILE) if lot.random() < 0.01 else value

    for number in range(CHECKS):
        now += lot.choice((0.15, 0.03, 0.01, 0.6, 0.0, lot.random()))
        angle = 0.95 * angle + lot.gauss(0.0, 0.06)
        speed = lot.choice((0.0, 0.1, 5.0, 20.0, lot.uniform(-12.0, 12.0), lot.uniform(0.0, 32.0)))
        proposal: Records = np.zeros(1, GUARD_PROPOSAL)
        proposal[0] = (
            hostile(now),
            hostile(now - lot.choice((0.0, 0.0, 0.1, 0.6, -0.01))),
            number - lot.choice((0, 0, 0, 0, 3)),
            hostile(angle),
            hostile(lot.gauss(0.0, 0.8)),
            hostile(lot.gauss(4.0, 9.0)),
            hostile(lot.gauss(0.0, 2.5)),
            hostile(speed),
            hostile(angle + lot.gauss(0.0, 0.2)),
            lot.random() < 0.9,
        )
        found.append(("guard_command", proposal))
        if (other := lot.random()) < 0.1:
            found.append(("guard_take_back" if other < 0.06 else "guard_forget", None))
    return found


@needs_compiled
@pytest.mark.parametrize("name", ["default", "firmware"])
@pytest.mark.parametrize("seed", range(4))
def test_compiled_is_plain_python(name: str, seed: int) -> None:
    """After every step the decision and all memory have the same bytes."""
    compiled, plain = Form(name, False), Form(name, True)
    verdicts = set()
    for step in steps(seed):
        assert compiled.apply(step) == plain.apply(step), step
        verdicts.add(int(plain.decision[0].verdict))
    assert verdicts == {0, 1, 2}


@pytest.mark.parametrize("seed", range(4))
def test_a_snapshot_goes_on_as_the_original(seed: int) -> None:
    original, restored = (Form("default", False) for _ in range(2))
    drive = steps(seed)
    for step in drive[: CHECKS // 2]:
        original.apply(step)
    restored.state[:] = np.frombuffer(original.state.tobytes(), GUARD_STATE)
    restored.decision[:] = original.decision
    for step in drive[CHECKS // 2 :]:
        assert restored.apply(step) == original.apply(step)


def test_the_record_of_a_proposal_is_what_the_guard_is_asked() -> None:
    """Values in order, and those of the measurement after them."""
    asked = (12.5, 12.25, 3, 0.125, 0.25, 2.0, -0.5)
    guard = Guard(load_set("default").guard, 2.5, 0.5)
    guard.check(Proposal(*asked), 4.0, 0.0625, False)
    found = np.frombuffer(guard._asked, GUARD_PROPOSAL)[0].tolist()
    assert found == (*asked, 4.0, 0.0625, False)


def test_records_hold_no_python_objects() -> None:
    for dtype in (GUARD_PARAMS, GUARD_STATE, GUARD_PROPOSAL, GUARD_DECISION):
        assert not dtype.hasobject and dtype.isalignedstruct
