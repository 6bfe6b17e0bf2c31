# SPDX-License-Identifier: Apache-2.0
"""``island bench loop``."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from safety_island.cli import options
from safety_island.cli.demo.child import Child
from safety_island.cli.demo.children import bridge_child, island_child
from safety_island.cli.domains import pairs_from, reserve
from safety_island.cli.progress import prepare_kernels, tick_progress
from safety_island.errors import IslandError

if TYPE_CHECKING:
    from safety_island.bench.loop import LoopTimes

HELP = "odometry to command and back, through the bridge"
DOMAINS = (1, 2)


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    options.add_period(parser)
    options.add_params(parser)
    options.add_duration(parser, 20.0)
    options.add_json(parser, "the times")


def execute(arguments: argparse.Namespace) -> int:
    """Start island and bridge, and measure."""
    if arguments.duration <= 0.0:
        raise IslandError("--duration 0 has no end here: name the seconds to measure")
    prepare_kernels()
    with reserve(pairs_from(*DOMAINS)) as pair:
        if pair is None:
            raise IslandError("every DDS domain is in use on this machine; end other demos")
        times = _measure(arguments, (pair[0], pair[1]))
    if arguments.json:
        print(json.dumps(times.as_dict(), indent=2))
        return 0
    print(f"in   odometry to the island  median {times.in_median_us:>7.0f} us")
    print(f"out  tick to command back    median {times.out_median_us:>7.0f} us")
    print(f"sum  beyond the wait         median {times.total_median_us:>7.0f} us")
    print(
        f"{times.commands} commands; p99 in {times.in_p99_us:.0f} us, out {times.out_p99_us:.0f} us"
    )
    return 0


def _measure(arguments: argparse.Namespace, domains: tuple[int, int]) -> LoopTimes:
    from safety_island.bench.loop import measure
    from safety_island.dds.config import DdsConfig

    with TemporaryDirectory() as folder:
        children = [
            island_child(domains[1], arguments.params, arguments.period),
            bridge_child(domains, Path(folder)),
        ]
        expected = round(arguments.duration / (arguments.period or 0.15))
        try:
            for child in children:
                child.start()
            with tick_progress("measuring", expected, sys.stderr) as report:
                return measure(
                    domains,
                    arguments.duration,
                    DdsConfig(loopback_only=True),
                    lambda: _are_alive(children),
                    report,
                )
        finally:
            _end(children)


def _are_alive(children: Sequence[Child]) -> bool:
    """Read what they say, so that no pipe fills; whether both still run."""
    for child in children:
        for _ in child.events():
            pass
    return all(child.exit_code is None for child in children)


def _end(children: Sequence[Child]) -> None:
    for child in children:
        child.tell_to_stop()
    for child in children:
        child.wait()
        child.close()
