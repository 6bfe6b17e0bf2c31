# SPDX-License-Identifier: Apache-2.0
"""The longitudinal kernels as plain Python: the same source, the same numbers."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from safety_island.kernel.kernel import JIT

HERE = Path(__file__).parent
PARITY = HERE.parent / "golden" / "test_longitudinal_parity.py"

GOLDEN = "curve/ctrl0.15_unconstraint_fast] or reverse/ctrl0.15_unconstraint_fast_alt] or startup"
"""One short run of each kind: plain, every optional feature in reverse, topics one by one."""


def run_plain(*arguments: str) -> subprocess.CompletedProcess[str]:
    """Run pytest in a process of its own with ``SAFETY_ISLAND_JIT=0``."""
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *arguments],
        cwd=HERE.parent.parent,
        env=os.environ | {"SAFETY_ISLAND_JIT": "0"},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.skipif(not JIT, reason="this process runs plain Python already")
@pytest.mark.parametrize(
    "arguments",
    [
        (str(PARITY), "-k", GOLDEN),
        tuple(
            str(HERE / f"test_{name}.py")
            for name in (
                "longitudinal",
                "longitudinal_command",
                "longitudinal_departure",
                "longitudinal_far",
                "longitudinal_history",
                "longitudinal_machine",
                "longitudinal_stopping",
                "pid",
                "point_list",
                "points",
                "slope",
                "smooth_stop",
                "trajectory_walk",
            )
        ),
    ],
    ids=["golden runs", "unit tests"],
)
def test_the_same_tests_pass_without_compilation(arguments: tuple[str, ...]) -> None:
    result = run_plain(*arguments)
    assert result.returncode == 0, result.stdout[-4000:] + result.stderr[-1000:]
    assert " passed" in result.stdout
    assert "skipped" not in result.stdout
