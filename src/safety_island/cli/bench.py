"""``island bench``: measurements on this machine, as ratios to a yardstick of the same run."""

from __future__ import annotations

import argparse
import json
import sys

from safety_island.cli.options import add_json
from safety_island.cli.parser import teach
from safety_island.cli.progress import prepare_kernels, tick_progress

PURPOSE = """
Measure on this machine. 'tick' is the time of one tick of both controllers in process: decoded
inputs to command, a new 220-point trajectory every tick, pinned to one core, after warm-up. Its
yardstick is one cold solve of a fixed problem by OSQP, measured in between; Autoware's C++
controllers take 1.9 yardsticks for the same tick.
"""

SOLVERS = ("unconstraint_fast", "daqp")


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare ``tick``."""
    teach(
        parser,
        PURPOSE,
        ("island bench tick", "both solvers of our own"),
        ("island bench tick --solver daqp --json", "one of them, for a script"),
    )
    kinds = parser.add_subparsers(dest="kind", metavar="tick", required=True)
    tick = kinds.add_parser("tick", help="one tick of both controllers")
    tick.add_argument("--solver", choices=SOLVERS, help="measure this solver only")
    tick.add_argument(
        "--rounds", type=_rounds, default=10, metavar="N", help="rounds of 300 ticks (default: 10)"
    )
    add_json(tick, "median_us, p99_us, max_us, yardstick_us and ratio of one solver")


def _rounds(text: str) -> int:
    if not text.isascii() or not text.isdigit() or not 1 <= int(text) <= 1000:
        raise argparse.ArgumentTypeError(f"'{text}' is not a number of rounds (1 to 1000)")
    return int(text)


def execute(arguments: argparse.Namespace) -> int:
    """Measure."""
    prepare_kernels()
    return _tick(arguments)


def _tick(arguments: argparse.Namespace) -> int:
    from safety_island.bench.tick import measure

    chosen = [arguments.solver] if arguments.solver else list(SOLVERS)
    if arguments.json:
        print(json.dumps(measure(chosen[0], arguments.rounds).as_dict(), indent=2))
        return 0
    print(f"{'solver':<18} {'median':>9} {'p99':>9} {'max':>9} {'yardstick':>10} {'ratio':>7}")
    for solver in chosen:
        with tick_progress(f"measuring {solver}", arguments.rounds + 2, sys.stderr) as report:
            t = measure(solver, arguments.rounds, report)
        print(
            f"{t.solver:<18} {t.median_us:>6.1f} us {t.p99_us:>6.1f} us {t.max_us:>6.1f} us "
            f"{t.yardstick_us:>7.1f} us {t.ratio:>7.3f}"
        )
    print("ratio: median tick over the yardstick (C++ controllers: 1.9)")
    return 0
