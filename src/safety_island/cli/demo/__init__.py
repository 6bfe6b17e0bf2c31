"""``island demo``: three processes, one live view, no configuration."""

from __future__ import annotations

import argparse
import json
import math
import signal
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from safety_island.cli import options
from safety_island.cli.demo.children import bridge_child, island_child, vehicle_child
from safety_island.cli.demo.events import DemoState
from safety_island.cli.demo.judge import Condition, conditions
from safety_island.cli.demo.session import Session
from safety_island.cli.demo.show import PlainShow, TerminalShow
from safety_island.cli.domains import pairs_from, reserve
from safety_island.cli.parameters import read_parameters
from safety_island.cli.parser import UsageError, teach
from safety_island.cli.run_settings import HOSTED
from safety_island.errors import IslandError
from safety_island.platform.signals import stop_signals
from safety_island.sim.courses import COURSES, DEFAULT_COURSE, load_course

GRACE_S = 10.0
"""A drive that takes this much longer [s] than planned is ended."""

DOMAINS = (1, 2)
"""Main compute and safety island, when nobody else uses them on this machine."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    teach(
        parser,
        """
Watch the safety island drive a vehicle. Three processes on this machine, over loopback: a main
compute with a planner and a vehicle on one DDS domain, the island on another, a bridge between
them. Exit code 0 only when the vehicle stayed on the course, reached its speed, stopped where the
planner said, and no tick was missed.
""",
        ("island demo", "the s-curve, about a minute"),
        ("island demo --course u-turn --period 0.03", "another course, at Autoware's own period"),
        ("island demo --target freertos_posix", "with CAN output: frames beside the commands"),
        ("island demo --duration 0", "lap after lap, until Ctrl-C"),
        ("island demo --plain", "plain lines, as when the output is no terminal"),
    )
    parser.add_argument(
        "--course",
        choices=tuple(COURSES),
        default=DEFAULT_COURSE,
        help=f"what to drive (default: {DEFAULT_COURSE})",
    )
    parser.add_argument(
        "-t",
        "--target",
        choices=HOSTED,
        default="posix",
        help="what the island is started as; freertos_posix sends CAN frames too, into memory "
        "(default: posix)",
    )
    options.add_period(parser)
    options.add_params(parser)
    options.add_duration(parser, 60.0)
    parser.add_argument(
        "--domains",
        nargs=2,
        type=options.domain_id,
        metavar=("MAIN", "ISLAND"),
        help="DDS domains of main compute and island (default: 1 2, or the next pair that nobody "
        "uses on this machine)",
    )
    parser.add_argument("--plain", action="store_true", help="plain lines instead of a live view")
    options.add_json(parser, "the summary")


def execute(arguments: argparse.Namespace) -> int:
    """Run the demo; 0 when all went well."""
    if arguments.domains is not None and len(set(arguments.domains)) == 1:
        raise UsageError("--domains: found the same domain twice; a bridge needs two")
    read_parameters(arguments.params, arguments.period)  # a mistake is told before anything starts
    _prepare()
    for number in stop_signals():
        signal.signal(number, signal.default_int_handler)
    wanted = pairs_from(*DOMAINS) if arguments.domains is None else [tuple(arguments.domains)]
    with reserve(wanted) as pair:
        if pair is None:
            raise IslandError(_in_use(arguments.domains))
        if arguments.domains is None and pair != DOMAINS:
            _note(f"DDS domains 1 and 2 are in use on this machine; taking {pair[0]} and {pair[1]}")
        return _run(arguments, (pair[0], pair[1]))


def _run(arguments: argparse.Namespace, domains: tuple[int, int]) -> int:
    interrupted = False
    with TemporaryDirectory() as folder, _display(arguments, domains) as show:
        main, island = domains
        children = [
            island_child(island, arguments.params, arguments.period, arguments.target),
            bridge_child(domains, Path(folder)),
            vehicle_child(main, arguments.course, arguments.duration),
        ]
        limit_s = arguments.duration + GRACE_S if arguments.duration else math.inf
        session = Session(children, show, limit_s)
        try:
            session.run()
        except KeyboardInterrupt:
            interrupted = True
    found = conditions(session.state, interrupted)
    _tell(found, session.state, arguments.json)
    if interrupted and arguments.duration:
        return 128 + signal.SIGINT
    return 0 if all(condition.holds for condition in found) else 1


def _display(arguments: argparse.Namespace, domains: tuple[int, int]) -> PlainShow | TerminalShow:
    if arguments.json:
        return PlainShow(sys.stderr)
    if arguments.plain or not sys.stdout.isatty():
        return PlainShow(sys.stdout)
    title = f"safety island — {arguments.course} — domains {domains[0]} and {domains[1]}"
    return TerminalShow(load_course(arguments.course), title)


def _tell(found: list[Condition], state: DemoState, as_json: bool) -> None:
    if as_json:
        print(json.dumps(_summary(found, state), indent=2))
        return
    for condition in found:
        print(f"{'ok' if condition.holds else 'FAILED':>6}  {condition.text}")
    if state.first_control_s is not None:
        print(f"        first Control {state.first_control_s:.2f} s after the island's start")


def _summary(found: list[Condition], state: DemoState) -> dict[str, object]:
    return {
        "ok": all(condition.holds for condition in found),
        "conditions": {condition.name: condition.holds for condition in found},
        "first_control_s": state.first_control_s,
        "vehicle": state.vehicle_summary,
        "island": state.island_summary,
        "forwarded": state.forwarded,
    }


def _prepare() -> None:
    """Compile ahead of the processes, so that all can see what is going on."""
    import safety_island.control.follower  # noqa: F401  (defines every entry)
    from safety_island.cli.progress import prepare_kernels
    from safety_island.control import kernel

    if not kernel.is_cached():
        prepare_kernels()


def _in_use(domains: list[int] | None) -> str:
    if domains is None:
        return "every DDS domain is in use on this machine; end other demos"
    return (
        f"DDS domain {domains[0]} or {domains[1]} is in use on this machine;"
        " choose others with --domains, or leave the option out"
    )


def _note(text: str) -> None:
    print(f"island: {text}", file=sys.stderr)
