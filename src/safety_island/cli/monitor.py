# SPDX-License-Identifier: Apache-2.0
"""``island monitor``: the live page."""

from __future__ import annotations

import argparse
import os
import secrets
from typing import TYPE_CHECKING

from safety_island.cli import options
from safety_island.cli.parser import teach

if TYPE_CHECKING:
    from safety_island.monitor.program import Monitor, MonitorOptions

DEFAULT_PORT = 8140
NICE = 5
"""Whoever drives comes first."""
_TOKEN_BYTES = 16


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    teach(
        parser,
        """
Serve a page on which one sees the island drive: top view, plots on one time axis, states and their
reasons in words, inputs with rate and age, what was rejected. It subscribes like any other program
on the island's domain, in a process of its own: its end touches nothing, and neither does a slow
browser. Nothing is fetched from the network. The address is printed; a port in use is passed over.
""",
        ("island monitor", "watch the island on domain 2 of this machine"),
        ("island monitor --open", "and show the page in the browser"),
        ("island monitor --interface eth0", "watch an island on the network"),
        ("island monitor --bind 0.0.0.0", "for other machines too: the address has a token"),
    )
    options.add_domain(parser, 2, "the safety island")
    options.add_network(parser)
    options.add_params(parser)
    parser.add_argument(
        "--port",
        type=port,
        default=DEFAULT_PORT,
        metavar="NUMBER",
        help=f"TCP port; the next free one is taken where it is in use (default: {DEFAULT_PORT})",
    )
    parser.add_argument(
        "--bind",
        default="127.0.0.1",
        metavar="ADDRESS",
        help="address to serve on; other than loopback, the page asks for the token of the printed"
        " address (default: 127.0.0.1, this machine only)",
    )
    parser.add_argument("--open", action="store_true", help="open the page in the browser")
    parser.add_argument(
        "--console",
        action="store_true",
        help="obey JSON lines on standard input (buttons, marks, CAN frames) and report each button"
        " that is pressed; the end of the input ends the monitor. The demo uses it",
    )
    options.add_duration(parser, 0.0)
    options.add_json(parser, "the address, and each button that is pressed,")


def port(text: str) -> int:
    """Read a TCP port, 1 to 65535."""
    if not text.isascii() or not text.isdigit() or not 1 <= int(text) <= 65535:
        raise argparse.ArgumentTypeError(f"'{text}' is not a port: a whole number, 1 to 65535")
    return int(text)


def execute(arguments: argparse.Namespace) -> int:
    """Serve until told to stop."""
    import asyncio

    from safety_island.cli.browser import open_page
    from safety_island.cli.jsonlines import JsonLines
    from safety_island.cli.stopping import StopFlag
    from safety_island.cli.tell import tell, tell_lost
    from safety_island.monitor.console import Console
    from safety_island.monitor.program import Monitor
    from safety_island.platform import load

    os.nice(NICE)
    platform, stop = load("posix"), StopFlag()
    report = JsonLines(tell_lost).write if arguments.json else None
    console = Console() if arguments.console else None

    def press(key: str) -> None:
        if report is not None:
            report("press", {"key": key})

    monitor = Monitor(_options(arguments), platform.clock, press if console else None)
    end = monitor.now() + (arguments.duration or float("inf"))

    def is_over() -> bool:
        closed = console is not None and console.is_closed
        return closed or stop.is_set() or monitor.now() >= end

    def on_address(address: str) -> None:
        if report is not None:
            report("address", {"address": address, "port": monitor.server.port})
        else:
            _say_where(arguments.port, monitor)
        if arguments.open and not open_page(address):
            tell("island: --open: there is no desktop to open the page on (DISPLAY is not set)")

    def between(monitor: Monitor) -> None:
        if console is not None:
            console.poll(monitor.hub, monitor.now())

    with platform.on_stop(stop.set):
        asyncio.run(monitor.run(is_over, on_address, between))
    return 0


def _say_where(wanted: int, monitor: Monitor) -> None:
    server = monitor.server
    if server.port != wanted:
        print(f"port {wanted} is in use; taking {server.port}")
    print(f"the page: {server.address}  (Ctrl-C ends it)", flush=True)


def _options(arguments: argparse.Namespace) -> MonitorOptions:
    from safety_island.cli.parameters import read_parameters
    from safety_island.monitor.access import is_loopback
    from safety_island.monitor.program import MonitorOptions
    from safety_island.monitor.server import Place

    needs_token = arguments.console or not is_loopback(arguments.bind)
    token = secrets.token_urlsafe(_TOKEN_BYTES) if needs_token else ""
    return MonitorOptions(
        domain=arguments.domain,
        where=f"domain {arguments.domain}, interface {arguments.interface}",
        dds=options.dds_config(arguments),
        parameters=read_parameters(arguments.params).parameters,
        place=Place(arguments.bind, arguments.port, token),
    )
