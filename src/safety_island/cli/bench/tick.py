# SPDX-License-Identifier: Apache-2.0
"""``island bench tick``."""

from __future__ import annotations

import argparse
import json
import sys

from safety_island.bench.ratios import AS_SHIPPED, HEAP_TUNED, METHOD, WHOLE_NODE, YARDSTICK
from safety_island.cli.options import add_json
from safety_island.cli.progress import prepare_kernels, tick_progress
from safety_island.extras import require

HELP = "one tick of both controllers"
SOLVERS = ("unconstraint_fast", "daqp")


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--solver", choices=SOLVERS, help="measure this solver only")
    add_rounds(parser)
    add_json(parser, "median_us, p99_us, max_us, yardstick_us and ratio of one solver")


def add_rounds(parser: argparse.ArgumentParser) -> None:
    """Add ``--rounds``."""
    parser.add_argument(
        "--rounds", type=_rounds, default=10, metavar="N", help="rounds of 300 ticks (default: 10)"
    )


def _rounds(text: str) -> int:
    if not text.isascii() or not text.isdigit() or not 1 <= int(text) <= 1000:
        raise argparse.ArgumentTypeError(f"'{text}' is not a number of rounds (1 to 1000)")
    return int(text)


def execute(arguments: argparse.Namespace) -> int:
    """Measure."""
    require("osqp", "island bench tick (its yardstick is a solve by OSQP)")
    from safety_island.bench.tick import measure

    prepare_kernels()
    chosen = [arguments.solver] if arguments.solver else list(SOLVERS)
    if arguments.json:
        print(json.dumps(measure(chosen[0], arguments.rounds).as_dict(), indent=2))
        return 0
    print(
        f"{'solver':<18} {'median':>9} {'p99':>9} {'max':>9} {'yardstick':>10} {'ratio':>7} "
        f"{'whole node':>11}"
    )
    for solver in chosen:
        with tick_progress(f"measuring {solver}", arguments.rounds + 2, sys.stderr) as report:
            t = measure(solver, arguments.rounds, report)
        print(
            f"{t.solver:<18} {t.median_us:>6.1f} us {t.p99_us:>6.1f} us {t.max_us:>6.1f} us "
            f"{t.yardstick_us:>7.1f} us {t.ratio:>7.3f} {t.node_ratio:>11.3f}"
        )
    print(f"ratio: median tick over the yardstick: {YARDSTICK}")
    print("whole node: the same, with bytes, gate, life cycle, guard and status around it")
    print(
        f"C++ controllers over ours: {HEAP_TUNED:g} at their best (heap tuned), {AS_SHIPPED:g} as"
        f" shipped; over our whole node: {WHOLE_NODE:g}; {METHOD}"
    )
    return 0
