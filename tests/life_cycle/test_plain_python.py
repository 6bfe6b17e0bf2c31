# SPDX-License-Identifier: Apache-2.0
"""Compiled code and plain Python do the same, bit for bit; memory is bytes that can be put back."""

from __future__ import annotations

import hashlib
import os
import random
import subprocess
import sys
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import pytest

from safety_island.kernel.kernel import JIT
from safety_island.life_cycle.facts import Facts
from safety_island.life_cycle.life_cycle import IslandWatch, LifeCycle
from safety_island.life_cycle.limits import MAX_PUBLISHERS
from safety_island.life_cycle.params import LifeCycleParams
from safety_island.life_cycle.ramp import Motion
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from tests.life_cycle.parameters import PARAMETERS

ROOT = Path(__file__).parents[2]
SEEDS = range(16)
TICKS = 150
GUIDS = [bytes([i] * 8 + [255 - i] * 8) for i in range(MAX_PUBLISHERS + 4)]


class Drive:
    """A life cycle with a life of chance: inputs that go, ticks that crash, clocks that jump."""

    def __init__(self, seed: int) -> None:
        self.chance = random.Random(seed)
        self.period_s = self.chance.choice((0.03, 0.15))
        has_ramp = self.chance.random() < 0.5
        self.life_cycle = LifeCycle(some_parameters(self.chance), self.period_s, has_ramp)
        self.islands = IslandWatch(5.0, 0.7, self.life_cycle.memory["islands"])
        self.now, self.slept_s = 5.0, 0.0
        self.trouble = 0.0
        self.speed = self.chance.uniform(-0.2, 9.0)

    def tick(self) -> tuple[Any, ...]:
        """Do one tick; return all that can be seen of it."""
        chance, life_cycle = self.chance, self.life_cycle
        if chance.random() < 0.05:  # quiet and troubled times take turns
            self.trouble = chance.choice((0.0, 0.0, 0.02, 0.3))
        skipped = self._often() * chance.randrange(4)
        self.now += self.period_s * (1 + skipped) * chance.uniform(0.9, 1.1) + self._seldom() * 2.0
        self.slept_s += self._seldom() * chance.uniform(-1.0, 3.0)
        began = life_cycle.begin(self.now, self.slept_s, skipped)
        if self._often():
            self.islands.update(
                set(chance.sample(GUIDS, chance.choice((0, 0, 1, 2, 19)))), self.now
            )
        blocked = self.islands.blocked(self._often(), chance.random() < 0.5, self.now)
        crashes = self._often()
        life = life_cycle.fault() if crashes else life_cycle.judge(self._facts(blocked), self.now)
        motion = life_cycle.motion()
        if life.state in (State.READY, State.ACTIVE):
            sent = Motion(*(chance.uniform(-3.0, 3.0) for _ in range(4)))
            life_cycle.sent(sent, not self._often(), self.now)
        flags = life_cycle.controls, life_cycle.is_armed, life_cycle.must_stop
        return began, life, motion, flags, self.islands.is_newcomer, self.memory()

    def shell(self) -> tuple[Any, ...]:
        """What the drive itself remembers."""
        return self.chance.getstate(), self.now, self.slept_s, self.trouble, self.speed

    def set_shell(self, shell: tuple[Any, ...]) -> None:
        self.chance.setstate(shell[0])
        self.now, self.slept_s, self.trouble, self.speed = shell[1:]

    def memory(self) -> str:
        """Hash of all memory."""
        return hashlib.sha256(self.life_cycle.memory.tobytes()).hexdigest()

    def _often(self) -> bool:
        return self.chance.random() < self.trouble

    def _seldom(self) -> bool:
        return self.chance.random() < 0.05 * self.trouble

    def _facts(self, others: Reason) -> Facts:
        chance = self.chance
        self.speed = 0.9 * self.speed + self._often() * chance.uniform(-3.0, 9.0)
        inputs = chance.choice(tuple(Reason)) if self._often() else Reason.NONE
        modes = (Reason.NOT_AUTONOMOUS, Reason.NOT_AUTONOMOUS, Reason.MODE_WRITER_GONE)
        return Facts(
            others or inputs,
            chance.choice(modes) if chance.random() < 0.05 + self.trouble / 2 else Reason.NONE,
            float("nan") if self._seldom() else self.speed,
            chance.random() < 0.1,
            self._often(),
            chance.random() < 2 * self.trouble,
            Reason.COMMAND_REFUSED if self._often() else Reason.NONE,
            self._often(),
        )


def some_parameters(chance: random.Random) -> LifeCycleParams:
    """Parameters within their ranges, mostly small ones, so that much happens."""
    changes: dict[str, Any] = {
        item.name: chance.randint(int(item.metadata["low"]), 6)
        if item.type == "int"
        else chance.uniform(item.metadata["low"], min(item.metadata["high"], 3.0))
        for item in fields(LifeCycleParams)
        if item.type != "str"
    }
    params: LifeCycleParams = replace(PARAMETERS, **changes)
    return replace(params, stop_steering=chance.choice(("hold", "centre")))


def digest() -> str:
    """Hash of all that many drives let see, memory included, to the last bit."""
    found = hashlib.sha256()
    for seed in SEEDS:
        drive = Drive(seed)
        for _ in range(TICKS):
            found.update(repr(drive.tick()).encode())
    return found.hexdigest()


@pytest.mark.skipif(not JIT, reason="this process runs plain Python already")
def test_compiled_and_plain_are_bit_for_bit_the_same() -> None:
    result = subprocess.run(
        [sys.executable, "-c", f"from {__name__} import digest; print(digest())"],
        cwd=ROOT,
        env=os.environ | {"SAFETY_ISLAND_JIT": "0", "PYTHONPATH": f"{ROOT / 'src'}:{ROOT}"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 0, result.stderr[-2000:]
    assert result.stdout.strip() == digest()


def test_the_drives_of_chance_reach_every_state_and_most_reasons() -> None:
    lives = set()
    for seed in SEEDS:
        drive = Drive(seed)
        lives |= {drive.tick()[1] for _ in range(TICKS)}
    assert {life.state for life in lives} == set(State)
    assert len({life.reason for life in lives}) > 15


@pytest.mark.parametrize("seed", SEEDS[:4])
def test_from_one_snapshot_the_same_inputs_give_the_same_bytes(seed: int) -> None:
    """Also in another life cycle: the object around the memory adds nothing."""
    drive, other = Drive(seed), Drive(seed)
    for _ in range(TICKS):
        drive.tick()
    snapshot, shell = drive.life_cycle.memory.tobytes(), drive.shell()
    first = [drive.tick() for _ in range(TICKS)]
    assert drive.life_cycle.memory.tobytes() != snapshot
    for again in (drive, other):
        again.life_cycle.memory.view("u1")[:] = bytearray(snapshot)
        again.set_shell(shell)
        assert [again.tick() for _ in range(TICKS)] == first
