# SPDX-License-Identifier: Apache-2.0
"""The machine's clocks: a suspended machine is noticed."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from safety_island.platform.posix.clock import PosixClock

ROOT = Path(__file__).parents[3]
SLEEP_S = 4321
ASK = "from safety_island.platform.posix.clock import PosixClock; print(PosixClock().slept_ns())"


def test_time_for_which_the_machine_was_suspended_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """The clock that goes on in a sleep, less the one that stands still."""
    clock = PosixClock()
    before = clock.slept_ns()
    real = time.clock_gettime_ns
    is_boot = {time.CLOCK_BOOTTIME: SLEEP_S * 10**9}
    monkeypatch.setattr(time, "clock_gettime_ns", lambda kind: real(kind) + is_boot.get(kind, 0))
    assert clock.slept_ns() - before == pytest.approx(SLEEP_S * 1e9, abs=1e8)


def asked(*before: str) -> int:
    done = subprocess.run(
        [*before, sys.executable, "-c", ASK],
        env={**os.environ, "PYTHONPATH": str(ROOT / "src")},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    if before and done.returncode and "unshare" in done.stderr:
        pytest.skip(f"no time namespace here: {done.stderr.strip()}")
    assert done.returncode == 0, done.stderr
    return int(done.stdout)


@pytest.mark.skipif(shutil.which("unshare") is None, reason="needs unshare of util-linux")
def test_a_real_clock_after_a_sleep_tells_it() -> None:
    """In a time namespace whose boot was longer ago, as after a sleep."""
    namespace = ["unshare", "--user", "--map-root-user", "--time", "--boottime", str(SLEEP_S)]
    assert asked(*namespace) - asked() == pytest.approx(SLEEP_S * 1e9, abs=1e8)
