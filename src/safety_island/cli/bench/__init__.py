"""``island bench``: measurements on this machine, as ratios to a yardstick of the same run."""

from __future__ import annotations

import argparse

from safety_island.cli.bench import loop, tick, virtual
from safety_island.cli.parser import teach

PURPOSE = """
Measure on this machine. 'tick' is the time of one tick of both controllers in process: decoded
inputs to command, a new 220-point trajectory every tick, pinned to one core, after warm-up. Its
yardstick is one cold solve of a fixed problem by OSQP, measured in between; Autoware's C++
controllers take 1.9 yardsticks for the same tick. 'loop' is the way from odometry on the main
compute's domain to the command back there, less the wait for the tick, with island and bridge in
processes of their own. 'virtual' plays the same run to the whole node in virtual time, as a fault
campaign does, and tells how many times real time that is.
"""


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
