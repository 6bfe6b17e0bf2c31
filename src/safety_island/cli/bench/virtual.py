# SPDX-License-Identifier: Apache-2.0
"""``island bench virtual``."""

from __future__ import annotations

import argparse
import json
import sys

from safety_island.cli.bench.tick import SOLVERS, add_rounds
from safety_island.cli.options import add_json
from safety_island.cli.progress import prepare_kernels, tick_progress

HELP = "how many times real time the island runs in virtual time"


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument(
        "--solver", choices=SOLVERS, default="daqp", help="solver of the MPC (default: daqp)"
    )
    add_rounds(parser)
    add_json(parser, "real_time_factor, tick_us, p99_us, max_us, ticks and period_s")


def execute(arguments: argparse.Namespace) -> int:
    """Measure."""
    from safety_island.bench.virtual import measure

    prepare_kernels()
    title = f"measuring {arguments.solver}"
    with tick_progress(title, arguments.rounds + 2, sys.stderr) as report:
        times = measure(arguments.rounds, arguments.solver, report)
    if arguments.json:
        print(json.dumps(times.as_dict(), indent=2))
        return 0
    print(f"{times.real_time_factor:.0f} times real time at {times.period_s * 1e3:g} ms")
    print(
        f"one tick of the whole node {times.tick_us:.0f} us at the median of the best round,"
        f" {times.p99_us:.0f} us p99, {times.max_us:.0f} us at most; {times.ticks} ticks"
    )
    return 0
