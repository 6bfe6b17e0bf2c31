# SPDX-License-Identifier: Apache-2.0
"""The records hold all memory of the stamps; compiled code and plain Python fill them alike."""

from __future__ import annotations

import copy
import os
import subprocess
import sys
from collections import Counter

from safety_island.input_gate.reason import SampleReason
from tests.input_gate.clock.drive import Drive


def test_the_random_drives_reach_every_outcome() -> None:
    drive, found = Drive(5), Counter[str]()
    for _ in range(1500):
        found.update(drive.tick()[:-1])
    stamps = drive.sender.stamps[:4]
    reasons = (SampleReason.OLDER, SampleReason.DELAYED, SampleReason.STAMP_STANDS_STILL)
    assert all(found[str(reason)] > 5 for reason in (*reasons, SampleReason.DUPLICATE, None))
    assert (stamps["steps_back"] > 3).all() and (stamps["steps"] > stamps["steps_back"]).all()


def test_a_snapshot_that_is_restored_goes_on_alike() -> None:
    drive = Drive(9)
    for _ in range(300):
        drive.tick()
    stamps, clock = drive.sender.stamps.copy(), drive.sender.state.copy()
    held = [gate._held for gate in drive.inputs]
    dice, place = copy.deepcopy(drive.dice), (drive.now, drive.clock_s, drive.rate)
    first = [(drive.tick(), drive.memory()) for _ in range(300)]
    drive.sender.stamps[:], drive.sender.state[:] = stamps, clock
    for gate, data in zip(drive.inputs, held, strict=True):
        gate._held = data
    drive.dice, (drive.now, drive.clock_s, drive.rate) = dice, place
    assert [(drive.tick(), drive.memory()) for _ in range(300)] == first


def test_plain_python_gives_the_same_bytes() -> None:
    found = {
        subprocess.run(
            [sys.executable, "-m", "tests.input_gate.clock.drive"],
            env=os.environ | {"SAFETY_ISLAND_JIT": jit},
            check=True,
            capture_output=True,
            text=True,
        ).stdout
        for jit in ("0", "1")
    }
    assert len(found) == 1 and len(found.pop()) == 65
