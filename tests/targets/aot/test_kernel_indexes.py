# SPDX-License-Identifier: Apache-2.0
"""No kernel indexes below zero: a library compiled ahead of time would read what lies before."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from safety_island.kernel.kernel import JIT

ROOT = Path(__file__).parents[3]
DRIVES = (
    "tests/golden/test_parity.py::test_a_run_is_the_firmwares",  # every recording
    "tests/golden/test_current.py",
    "tests/control/test_follower_robustness.py",
)


@pytest.mark.skipif(not JIT, reason="counts in kernels that are compiled here")
@pytest.mark.timeout(1800)  # every kernel is compiled once more: some 2 minutes on an idle machine
def test_no_kernel_indexes_below_zero(tmp_path: Path) -> None:
    plugin = [
        "-p",
        "tests.targets.aot.negative_indexes",
        "-p",
        "no:cacheprovider",
        "--timeout=1200",
    ]
    result = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", *plugin, *DRIVES],
        cwd=ROOT,
        env=os.environ
        | {"SAFETY_ISLAND_CACHE": str(tmp_path), "PYTHONPATH": f"{ROOT / 'src'}:{ROOT}"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert "negative indexes: 0" in result.stdout, result.stdout[-2000:] + result.stderr[-1000:]
    assert result.returncode == 0, result.stdout[-2000:]
