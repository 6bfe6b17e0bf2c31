"""``island can monitor``: decode a live bus or a log."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Protocol

from safety_island.can.monitor import RECENT, BusMonitor
from safety_island.can.report import command_text, command_values, summary_lines, summary_values
from safety_island.cli.options import add_duration, add_json, period_s
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
        default=0.15,
        metavar="SECONDS",
        help="control period of the island: three without a command are a loss (default: 0.15)",
    )
    parser.add_argument(
        "--summary", action="store_true", help="leave out the single commands of a log"
    )
    add_duration(parser, 0.0)
    add_json(parser, "what was found (a live bus: one line each second)")
    parser.set_defaults(run=execute)


def execute(arguments: argparse.Namespace) -> int:
    """Decode until the log ends, the time is over, or the user stops it."""
    if arguments.log is not None:
        _decode_log(arguments)
    else:
        _watch(arguments)
    return 0


def _decode_log(arguments: argparse.Namespace) -> None:
    from safety_island.can.log_reader import read_log

    monitor = BusMonitor(arguments.period)
    commands: list[dict[str, Any]] = []
    last_s = 0.0
    for entry in read_log(arguments.log):
        last_s = entry.time_s
        seen = monitor.feed(entry)
        if seen is None or arguments.summary:
            continue
        if arguments.json:
            commands.append(command_values(seen))
        else:
            print(command_text(seen))
    if arguments.json:
        listed = {} if arguments.summary else {"decoded": commands}
        print(json.dumps({"log": arguments.log} | summary_values(monitor, last_s) | listed))
    else:
        print("\n".join(summary_lines(monitor, last_s)))


class _Display(Protocol):
    """Shows the state of a live bus, about once a second and at the end."""

    def __call__(self, monitor: BusMonitor, now_s: float) -> None: ...


def _watch(arguments: argparse.Namespace) -> None:
    from safety_island.can.live import watch
    from safety_island.can.spec import parse_spec
    from safety_island.platform.posix.clock import PosixClock

    clock = PosixClock()
    monitor = BusMonitor(arguments.period, RECENT)
    entries = watch(parse_spec(arguments.can))
    try:
        with _display(arguments) as show:
            _feed(monitor, entries, clock, arguments.duration, show)
    finally:
        entries.close()


def _feed(
    monitor: BusMonitor,
    entries: Iterator[Any],
    clock: Clock,
    duration_s: float,
    show: _Display,
) -> None:
    started_ns = shown_ns = clock.monotonic_ns()
    end_ns = started_ns + int(duration_s * _NS_PER_S) if duration_s else None
    try:
        for entry in entries:
            if entry is not None:
                monitor.feed(entry)
            now_ns = clock.monotonic_ns()
            if end_ns is not None and now_ns >= end_ns:
                break
            if now_ns - shown_ns >= _REFRESH_NS:
                shown_ns = now_ns
                show(monitor, clock.now())
    except KeyboardInterrupt:
        pass  # the usual way to end it; what was found is still shown
    show(monitor, clock.now())


@contextmanager
def _display(arguments: argparse.Namespace) -> Iterator[_Display]:
    if arguments.json:
        yield lambda monitor, now_s: print(json.dumps(summary_values(monitor, now_s)), flush=True)
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
