# SPDX-License-Identifier: Apache-2.0
"""``island can monitor``: decode a live bus or a log."""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from itertools import chain, repeat
from typing import Any, Protocol

from safety_island.can.candump import LogEntry
from safety_island.can.monitor import RECENT, BusMonitor
from safety_island.can.receiver import Link
from safety_island.can.report import command_text, command_values, summary_lines, summary_values
from safety_island.cli.jsonlines import HEAD
from safety_island.cli.options import add_duration, add_json, period_s
from safety_island.cli.parser import UsageError
from safety_island.cli.stopping import StopFlag
from safety_island.cli.tell import tell
from safety_island.platform.interfaces import Clock

DEFAULT_BUS = "socketcan:can0"
_REFRESH_NS = 1_000_000_000
_NS_PER_S = 1e9


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    source = parser.add_mutually_exclusive_group()
    source.add_argument("log", nargs="?", metavar="FILE", help="a log; - is standard input")
    source.add_argument(
        "--can", default=DEFAULT_BUS, metavar="BUS", help=f"a live bus (default: {DEFAULT_BUS})"
    )
    parser.add_argument(
        "--period",
        type=period_s,
        metavar="SECONDS",
        help="control period of the island: three without a command are a loss (default: as its "
        "frames show)",
    )
    parser.add_argument(
        "--channel",
        metavar="NAME",
        help="channel of a log that has several, for example can0 (.asc, .blf: 1)",
    )
    parser.add_argument(
        "--summary", action="store_true", help="leave out the single commands of a log"
    )
    add_duration(parser, 0.0)
    add_json(parser, "what was found (a live bus: one line each second)")
    parser.set_defaults(run=execute)


def execute(arguments: argparse.Namespace) -> int:
    """Decode until the log ends, the time is over, or the user stops it.

    Returns 1 when commands are lost at the end of watching a live bus.
    """
    if arguments.log is None:
        if arguments.channel is not None:
            raise UsageError("--channel: a live bus is one channel; name it in --can")
        return _watch(arguments)
    _decode_log(arguments)
    return 0


def _decode_log(arguments: argparse.Namespace) -> None:
    from safety_island.can.channels import Channels
    from safety_island.can.log_reader import LogNotes, read_log

    monitor = BusMonitor(arguments.period)
    commands: list[dict[str, Any]] = []
    last_s = 0.0
    channels, notes = Channels(arguments.channel), LogNotes(arguments.log)
    for entry in read_log(arguments.log, notes):
        if not channels.takes(entry):
            continue
        last_s = entry.time_s
        seen = monitor.feed(entry)
        if seen is None or arguments.summary:
            continue
        if arguments.json:
            commands.append(command_values(seen))
        else:
            print(command_text(seen))
    channels.check(arguments.log)
    for note in notes.sentences():
        tell(f"island: {note}")
    if arguments.json:
        listed = {} if arguments.summary else {"decoded": commands}
        head = {"log": arguments.log, "notes": notes.sentences()}
        print(json.dumps(head | summary_values(monitor, last_s) | listed))
    else:
        print("\n".join(summary_lines(monitor, last_s)))


class _Display(Protocol):
    """Shows the state of a live bus, about once a second and at the end."""

    def __call__(self, monitor: BusMonitor, now_s: float) -> None: ...


def _watch(arguments: argparse.Namespace) -> int:
    """Watch a live bus; times are those of the monotonic clock, which nobody sets."""
    from safety_island.can.live import watch
    from safety_island.can.spec import parse_spec
    from safety_island.platform.posix.clock import PosixClock
    from safety_island.platform.posix.process import on_stop

    clock, stop = PosixClock(), StopFlag()
    entries = watch(parse_spec(arguments.can))
    try:
        with _display(arguments) as show, on_stop(stop.set):
            return _feed(entries, clock, arguments, stop, show)
    finally:
        entries.close()


def _feed(
    entries: Iterator[LogEntry | None],
    clock: Clock,
    arguments: argparse.Namespace,
    stop: StopFlag,
    show: _Display,
) -> int:
    started_ns = shown_ns = now_ns = clock.monotonic_ns()
    end_ns = started_ns + arguments.duration * _NS_PER_S if arguments.duration else math.inf
    monitor = BusMonitor(arguments.period, RECENT, started_ns / _NS_PER_S)
    try:
        for entry in entries:
            now_ns = clock.monotonic_ns()
            if entry is not None:
                monitor.feed(entry, now_ns / _NS_PER_S)
            if now_ns >= end_ns or stop.is_set():
                break
            if now_ns - shown_ns >= _REFRESH_NS:
                shown_ns = now_ns
                show(monitor, now_ns / _NS_PER_S)
    except KeyboardInterrupt:
        pass  # a usual way to end it; what was found is still shown
    show(monitor, now_ns / _NS_PER_S)
    return int(monitor.losses.link(now_ns / _NS_PER_S) is Link.LOST)


def _json_lines() -> _Display:
    """Print one JSON object each time; the first says which version wrote it."""
    heads: Iterator[Mapping[str, object]] = chain([HEAD], repeat({}))

    def show(monitor: BusMonitor, now_s: float) -> None:
        print(json.dumps({**next(heads), **summary_values(monitor, now_s)}), flush=True)

    return show


@contextmanager
def _display(arguments: argparse.Namespace) -> Iterator[_Display]:
    if arguments.json:
        yield _json_lines()
    elif sys.stdout.isatty():
        from rich.live import Live
        from rich.text import Text

        with Live(auto_refresh=False) as live:
            yield lambda monitor, now_s: live.update(Text(_text(monitor, now_s)), refresh=True)
    else:
        yield lambda monitor, now_s: print(_text(monitor, now_s), flush=True)


def _text(monitor: BusMonitor, now_s: float) -> str:
    newest = command_text(monitor.latest) if monitor.latest else "no command yet"
    return "\n".join([newest, *summary_lines(monitor, now_s)])
