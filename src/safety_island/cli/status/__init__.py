# SPDX-License-Identifier: Apache-2.0
"""``island status``: what the island does, and why."""

from __future__ import annotations

import argparse
import json
import sys
from typing import TYPE_CHECKING

from safety_island.cli import options
from safety_island.cli.jsonlines import HEAD
from safety_island.cli.parser import teach

if TYPE_CHECKING:
    from safety_island.cli.status.receive import StatusReader
    from safety_island.cli.status.show import Show

NODE_NAME = "island_status"


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    teach(
        parser,
        """
Show what the island does: its state and why, its inputs, command, controllers, guard and times, as
its status message tells every tick. A terminal gets a live view, anything else a line a second.
docs/status.md explains each state and reason.
""",
        ("island status", "watch the island on domain 2 of this machine"),
        (
            "island status --why",
            "why nothing is published, what holds the vehicle, or that all is well",
        ),
        ("island status --interface eth0 --json", "every status as a JSON line, from a network"),
        ("island status --once", "one status, then end"),
    )
    kind = parser.add_mutually_exclusive_group()
    kind.add_argument(
        "--why",
        action="store_true",
        help="say why nothing is published, or what holds the vehicle, and what to do; that all is"
        " well only when it is free to drive. Looks for a second at the island and at the"
        " publishers of its inputs; the exit code is 0 when commands flow, 1 when not",
    )
    kind.add_argument("--once", action="store_true", help="show one status and end")
    options.add_domain(parser, 2, "the safety island")
    options.add_network(parser)
    options.add_timeout(parser, "a status")
    options.add_duration(parser, 0.0)
    options.add_json(parser, "every status")


def execute(arguments: argparse.Namespace) -> int:
    """Show one status, or all until told to stop; return the exit code."""
    from safety_island.cli.status.receive import StatusReader

    with StatusReader(arguments, NODE_NAME) as reader:
        if arguments.why:
            return _tell_why(arguments, reader)
        show = _show(arguments, reader)
        if arguments.once:
            with show:
                show([reader.first(arguments.timeout)], reader.now())
        else:
            _watch(arguments, reader, show)
    return 0


def _tell_why(arguments: argparse.Namespace, reader: StatusReader) -> int:
    from safety_island.status.why import why_values

    *before, status = reader.recent(arguments.timeout)
    values = why_values(status, before, reader.publishers())
    print(json.dumps({"event": "why", **HEAD, **values}) if arguments.json else values["why"])
    return 0 if values["flows"] else 1


def _watch(arguments: argparse.Namespace, reader: StatusReader, show: Show) -> None:
    """Show what comes until told to stop. Raises IslandError when the time passes with nothing."""
    from safety_island.cli.stopping import StopFlag
    from safety_island.platform import load

    stop = StopFlag()
    end = reader.now() + (arguments.duration or float("inf"))
    told_at = reader.now() + arguments.timeout
    with load("posix").on_stop(stop.set), show:
        while not stop.is_set() and reader.now() < end:
            show(reader.take(end - reader.now()), reader.now())
            if not reader.came and told_at <= reader.now() < end:
                told_at = float("inf")
                if arguments.json or not sys.stdout.isatty():  # the live view tells it itself
                    print(f"island: {reader.nothing(arguments.timeout)}", file=sys.stderr)
    if not reader.came and not stop.is_set():
        raise reader.nothing(arguments.duration)


def _show(arguments: argparse.Namespace, reader: StatusReader) -> Show:
    from safety_island.cli.status.show import JsonShow, PlainShow, TerminalShow

    if arguments.json:
        return JsonShow()
    if sys.stdout.isatty():
        return TerminalShow(f"safety island — {reader.where}", reader.now())
    return PlainShow()
