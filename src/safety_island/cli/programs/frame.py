# SPDX-License-Identifier: Apache-2.0
"""What the test programs have in common: arguments, an orderly end, errors as one line."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable

from safety_island.cli import options
from safety_island.cli.parser import Parser
from safety_island.cli.stopping import StopAtOnce, StopFlag
from safety_island.dds.config import DdsConfig
from safety_island.errors import IslandError
from safety_island.targets.package.built import built

DOMAIN, INTERFACE = 2, "lo"
"""Used from sources; a built program has those of its configuration."""

Body = Callable[[argparse.Namespace, DdsConfig, StopFlag], int]
"""Does the work until the flag is set; returns the exit code."""


def run(name: str, purpose: str, body: Body) -> int:
    """Read the arguments and run a program; returns its exit code."""
    try:
        arguments = _parser(name, purpose).parse(sys.argv[1:])
        with StopAtOnce() as start:
            from safety_island.platform.posix.process import on_stop

            stop = StopFlag()
            with on_stop(stop.set):
                start.disarm()
                dds = DdsConfig(arguments.interface, library=arguments.ddsc)
                return body(arguments, dds, stop)
    except IslandError as error:
        for line in str(error).splitlines():
            print(f"{name}: error: {line}", file=sys.stderr)
        return error.exit_code


def _parser(name: str, purpose: str) -> Parser:
    domain, interface = DOMAIN, INTERFACE
    own = built()
    if own is not None:
        config = own.configuration()
        domain, interface = config.dds_domain_id, config.dds_network_interface
    parser = Parser(prog=name)
    parser.description = purpose.strip()
    options.add_domain(parser, domain, "the safety island")
    parser.add_argument(
        "--interface",
        type=options.interface,
        default=interface or None,
        metavar="NAME",
        help=f"network interface (default: {interface or 'the library chooses'})",
    )
    options.add_library(parser)
    options.add_duration(parser, 0.0)
    return parser
