# SPDX-License-Identifier: Apache-2.0
"""A long run in virtual time, observed as ``island run`` observes it, takes no more memory.

``SAFETY_ISLAND_LONG_TICKS=1000000`` makes it as long as nine hours at 30 ms.
"""

from __future__ import annotations

import gc
import os
import sys

import pytest

from safety_island.cli.run_report import RunReport
from safety_island.platform.posix.process import memory_bytes
from tests.faults.scene import FAST, Scene

TICKS = int(os.environ.get("SAFETY_ISLAND_LONG_TICKS", "20000"))
ROUND = 1000
"""Ticks between two times that the log of the scene is thrown away."""


@pytest.mark.slow
@pytest.mark.timeout(TICKS)
def test_memory_is_flat_after_the_warm_up() -> None:
    """The summary of a run kept the newest 100,000 tick times: 4 MB in the first hour at 30 ms."""
    scene = Scene(FAST).drive()
    report = RunReport(scene.node, scene.follower.trace, lambda: 1.0, None)
    scene.node.observers.append(report)
    figures = []
    for _ in range(TICKS // ROUND):
        scene.run(ROUND * FAST)
        scene.rows.clear()
        scene.platform.logger.lines.clear()
        gc.collect()
        figures.append((sys.getallocatedblocks(), memory_bytes()))
    warm = figures[max(len(figures) // 10, 3)]
    blocks, size = (last - first for last, first in zip(figures[-1], warm, strict=True))
    print(f"{report.ticks} ticks: {blocks:+d} blocks, {size / 1024:+.0f} kB")
    assert report.ticks == TICKS and report.published > 0.9 * TICKS
    assert blocks < 1000 + TICKS // 1000, "less than one for a thousand ticks"
    assert size < 1 << 20
