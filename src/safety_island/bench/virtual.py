# SPDX-License-Identifier: Apache-2.0
"""``island bench virtual``: how many times real time the whole island runs in virtual time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass

import numpy as np

from safety_island import params
from safety_island.bench.node_tick import benchmark_run, node_round
from safety_island.bench.tick import quiet

_WARM_UP_ROUNDS = 2


@dataclass(frozen=True)
class VirtualTimes:
    """Real-time factor, and the time of one tick of the node [us].

    Factor and ``tick_us`` are of the round with the lowest median, which other programs have
    disturbed least; ``p99_us`` and ``max_us`` are of all rounds.
    """

    real_time_factor: float
    tick_us: float
    p99_us: float
    max_us: float
    ticks: int
    period_s: float

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        return asdict(self)


def measure(
    rounds: int = 10, solver: str = "daqp", report: Callable[[int], None] | None = None
) -> VirtualTimes:
    """Run the benchmark run ``rounds`` times after warm-up; ``report`` is told each round.

    What a tick is: see ``node_round``.
    """
    run = benchmark_run()
    period_s = params.from_mapping(run.overrides, "firmware").node.ctrl_period
    times: list[float] = []
    medians: list[float] = []
    with quiet():
        for index in range(_WARM_UP_ROUNDS + rounds):
            measured = node_round(solver)
            if index >= _WARM_UP_ROUNDS:
                times += measured
                medians.append(float(np.median(measured)))
            if report is not None:
                report(index)
    return VirtualTimes(
        real_time_factor=period_s * 1e6 / min(medians),
        tick_us=min(medians),
        p99_us=float(np.percentile(times, 99)),
        max_us=max(times),
        ticks=len(times),
        period_s=period_s,
    )
