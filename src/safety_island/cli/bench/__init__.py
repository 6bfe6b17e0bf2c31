# SPDX-License-Identifier: Apache-2.0
"""``island bench``: measurements on this machine, as ratios to a yardstick of the same run."""

from __future__ import annotations

import argparse
from textwrap import fill

from safety_island.bench.ratios import HEAP_TUNED, METHOD, YARDSTICK
from safety_island.cli.bench import loop, tick, virtual
from safety_island.cli.parser import teach

TICK = f"""
Measure on this machine. 'tick' is the time of one tick of both controllers in process: decoded
inputs to command, a new 220-point trajectory every tick, pinned to one core, after warm-up; and of
the whole node around them. Its yardstick is {YARDSTICK}.
Autoware's C++ controllers took {HEAP_TUNED:g} times as long as ours ({METHOD}).
"""
OTHERS = """
'loop' is the way from odometry on the main compute's domain to the command back there, not counting
the wait for the tick, with island and bridge in processes of their own. 'virtual' plays the same
run to the whole node in virtual time, as a fault campaign does, and tells how many times real time
that is.
"""
WIDTH = 100
PURPOSE = "\n".join(fill(" ".join(text.split()), WIDTH) for text in (TICK, OTHERS))


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare ``tick``, ``loop`` and ``virtual``."""
    teach(
        parser,
        PURPOSE,
        ("island bench tick", "both solvers of our own"),
        ("island bench tick --solver daqp --json", "one of them, for a script"),
        ("island bench loop --duration 30", "the way through bridge and island and back"),
        (
            "island bench virtual",
            "gate, controllers, guard, life cycle and status, as fast as it goes",
        ),
    )
    kinds = parser.add_subparsers(dest="kind", metavar="tick|loop|virtual", required=True)
    tick.configure(kinds.add_parser("tick", help=tick.HELP))
    loop.configure(kinds.add_parser("loop", help=loop.HELP))
    virtual.configure(kinds.add_parser("virtual", help=virtual.HELP))


def execute(arguments: argparse.Namespace) -> int:
    """Measure."""
    if arguments.kind == "tick":
        return tick.execute(arguments)
    if arguments.kind == "loop":
        return loop.execute(arguments)
    return virtual.execute(arguments)
