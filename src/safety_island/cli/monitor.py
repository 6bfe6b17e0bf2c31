# SPDX-License-Identifier: Apache-2.0
"""``island monitor``: the live page."""

from __future__ import annotations

import argparse
import os
import secrets
from ipaddress import ip_address
from typing import TYPE_CHECKING, Self

from safety_island.cli import options
from safety_island.cli.parser import teach

if TYPE_CHECKING:
    from safety_island.cli.stopping import StopFlag
    from safety_island.monitor.bus import BusFeed
    from safety_island.monitor.program import Monitor, MonitorOptions
    from safety_island.platform.interfaces import Clock

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
        type=address,
        default="127.0.0.1",
        metavar="ADDRESS",
        help="address to serve on; other than loopback, the page asks for the token of the printed"
        " address (default: 127.0.0.1, this machine only)",
    )
    parser.add_argument(
        "--can", metavar="BUS", help="show the frames of a CAN bus too, for example socketcan:can0"
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


def address(text: str) -> str:
    """Read an IP address to bind to."""
    try:
        return str(ip_address(text))
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"{text!r} is not an IP address, for example 127.0.0.1 or 0.0.0.0"
        ) from None


def port(text: str) -> int:
    """Read a TCP port, 1 to 65535."""
    if not text.isascii() or not text.isdigit() or not 1 <= int(text) <= 65535:
        raise argparse.ArgumentTypeError(f"'{text}' is not a port: a whole number, 1 to 65535")
    return int(text)


def execute(arguments: argparse.Namespace) -> int:
    """Serve until told to stop."""
    import asyncio

    from safety_island.cli.stopping import StopFlag
    from safety_island.platform import load

    os.nice(NICE)
    platform, stop = load("posix"), StopFlag()
    program = _Program(arguments, platform.clock, stop)
    with platform.on_stop(stop.set), program:
        asyncio.run(program.monitor.run(program.is_over, program.say_where, program.between))
    return 0


class _Program:
    """The monitor with what the command line adds: reports, lines to obey, a CAN bus, an end."""

    def __init__(self, arguments: argparse.Namespace, clock: Clock, stop: StopFlag) -> None:
        from safety_island.cli.jsonlines import JsonLines
        from safety_island.cli.tell import tell_lost
        from safety_island.monitor.console import Console
        from safety_island.monitor.program import Monitor

        self._arguments, self._stop = arguments, stop
        self._report = JsonLines(tell_lost).write if arguments.json else None
        self._console = Console() if arguments.console else None
        press = self._press if arguments.console else None
        self.monitor = Monitor(_options(arguments), clock, press)
        self._end = self.monitor.now() + (arguments.duration or float("inf"))
        self._bus = _open_bus(arguments.can, clock)

    def is_over(self) -> bool:
        """Whether to end."""
        closed = self._console is not None and self._console.is_closed
        return closed or self._stop.is_set() or self.monitor.now() >= self._end

    def say_where(self, address: str) -> None:
        """Say where the page is served, and open it when that was asked for."""
        from safety_island.cli.browser import open_page
        from safety_island.cli.tell import tell

        port = self.monitor.server.port
        if self._report is not None:
            self._report("address", {"address": address, "port": port})
        else:
            if port != self._arguments.port:
                print(f"port {self._arguments.port} is in use; taking {port}")
            print(f"the page: {address}  (Ctrl-C ends it)", flush=True)
        if self._arguments.open and not open_page(address):
            tell("island: --open: there is no desktop to open the page on (DISPLAY is not set)")

    def between(self, monitor: Monitor) -> None:
        """Pass on what others than the domain have for the page."""
        if self._console is not None:
            self._console.poll(monitor.hub, monitor.now())
        if self._bus is not None:
            self._bus.poll(monitor.hub, monitor.now())

    def _press(self, key: str) -> None:
        if self._report is not None:
            self._report("press", {"key": key})

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._bus is not None:
            self._bus.close()


def _open_bus(name: str | None, clock: Clock) -> BusFeed | None:
    if name is None:
        return None
    from safety_island.can.spec import parse_spec
    from safety_island.monitor.bus import BusFeed

    return BusFeed(parse_spec(name), clock.monotonic_ns)


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
