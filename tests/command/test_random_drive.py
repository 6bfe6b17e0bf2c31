# SPDX-License-Identifier: Apache-2.0
"""The kernels over random ticks: compiled and plain alike, and all memory is in the records."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from safety_island.kernel.kernel import JIT
from tests.command import random_drive
from tests.command.random_drive import TICKS, Drive, digest


@pytest.mark.skipif(not JIT, reason="this process runs plain Python already")
def test_compiled_code_and_plain_python_write_the_same_bytes() -> None:
    plain = subprocess.run(
        [sys.executable, "-m", random_drive.__name__],
        env=os.environ | {"SAFETY_ISLAND_JIT": "0"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert plain.stdout.strip() == digest()


def test_each_kernel_succeeds_and_refuses_within_a_drive() -> None:
    results = {step[:3] for step in random_drive.ticks()}
    assert [sorted({found[kernel] for found in results}) for kernel in range(3)] == [
        [0, 2],  # Control
        [0, 2],  # Status
        [0, 1, 2, 3],  # frames
    ]


def test_a_drive_goes_on_from_the_bytes_of_its_records() -> None:
    first, second = Drive(seed=7), Drive(seed=7)
    for _ in range(TICKS // 4):
        first.step()
    second._rng.setstate(first._rng.getstate())
    for name in ("control", "status"):
        getattr(second, name).body[:] = getattr(first, name).body
    assert [second.step() for _ in range(50)] == [first.step() for _ in range(50)]
