# SPDX-License-Identifier: Apache-2.0
"""The benchmark run, and the time of the whole node over it."""

from __future__ import annotations

from functools import cache
from importlib.resources import as_file, files
from time import perf_counter_ns

from safety_island.replay.feed import Message, Replay, messages
from safety_island.replay.recording import Recording, load

RUN = "ctrl0.15_unconstraint_fast.npz"


@cache
def benchmark_run() -> Recording:
    """Return the run: 300 ticks, before each of them a new trajectory of 220 points."""
    with as_file(files(__package__) / "data" / RUN) as path:
        return load(path)


@cache
def _benchmark_messages() -> list[list[Message]]:
    """Return what comes before each tick of the benchmark run, as bytes."""
    run = benchmark_run()
    return [messages(run, tick) for tick in range(run.ticks)]


def node_round(solver: str) -> list[float]:
    """Play the benchmark run to a new node; the time of each tick [us].

    A tick is all that the node does: it takes five inputs as bytes through the gate, runs both
    controllers, asks guard and life cycle, and sends command, times and status as bytes. The inputs
    were made before.
    """
    player = Replay(benchmark_run(), solver)
    times = []
    for tick, found in enumerate(_benchmark_messages()):
        now = player.deliver_messages(tick, found)
        start = perf_counter_ns()
        player.node.tick(now)
        times.append((perf_counter_ns() - start) / 1e3)
    return times
