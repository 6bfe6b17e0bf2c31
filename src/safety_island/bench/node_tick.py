"""The benchmark run, and the time of the whole node over it."""

from __future__ import annotations

from importlib.resources import as_file, files
from time import perf_counter_ns

from safety_island.replay.feed import Replay
from safety_island.replay.recording import Recording, load

RUN = "ctrl0.15_unconstraint_fast.npz"


def benchmark_run() -> Recording:
    """Return the run: 300 ticks, before each of them a new trajectory of 220 points."""
    with as_file(files(__package__) / "data" / RUN) as path:
        return load(path)


def node_round(run: Recording, solver: str) -> list[float]:
    """Play the run to a new node; the time of each tick [us].

    A tick is all that the node does: it takes five inputs as bytes through the gate, runs both
    controllers, asks guard and life cycle, and sends command, times and status as bytes. Making
    the inputs is not counted.
    """
    player = Replay(run, solver)
    times = []
    for tick in range(run.ticks):
        now = player.deliver(tick)
        start = perf_counter_ns()
        player.node.tick(now)
        times.append((perf_counter_ns() - start) / 1e3)
    return times
