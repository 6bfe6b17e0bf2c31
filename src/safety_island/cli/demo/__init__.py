# SPDX-License-Identifier: Apache-2.0
"""``island demo``: the processes of a drive, one live view, one page, no configuration."""

from __future__ import annotations

import argparse
import json
import math
import signal
import sys
import time
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory

from safety_island.cli import options
from safety_island.cli.demo.actions import Actions, Reactions, Recipes
from safety_island.cli.demo.child import Child
from safety_island.cli.demo.children import (
    arm_child,
    bridge_child,
    island_child,
    page_child,
    vehicle_child,
)
from safety_island.cli.demo.events import ISLAND, SECOND_ISLAND, DemoState
from safety_island.cli.demo.judge import Condition, conditions
from safety_island.cli.demo.keyboard import Keyboard
from safety_island.cli.demo.machine_load import other_work, usage
from safety_island.cli.demo.page import PageLines
from safety_island.cli.demo.plot import plot
from safety_island.cli.demo.record import Recorder, open_output
from safety_island.cli.demo.session import Session
from safety_island.cli.demo.show import PlainShow, TerminalShow
from safety_island.cli.domains import pairs_from, reserve
from safety_island.cli.parameters import read_parameters
from safety_island.cli.parser import UsageError, teach
from safety_island.cli.run_settings import HOSTED
from safety_island.cli.stopping import StopFlag
from safety_island.errors import IslandError
from safety_island.params import IslandParameters
from safety_island.platform.signals import stop_signals
from safety_island.sim.courses import COURSES, DEFAULT_COURSE, load_course
from safety_island.sim.fit import fit

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
them. A fourth serves a page for the browser, with plots, and buttons that break things; nothing
depends on it. Exit code 0 only when the vehicle stayed on the course, reached its speed, stopped
where the planner said, and no tick was missed. In a terminal keys disturb the drive and show the
reaction: space disengages and engages, k kills the bridge, n makes the odometry NaN, f freezes a
topic, 2 starts a second island (each of them once more clears it), a arms the island, q ends. A
drive that keys disturbed is judged by what it kept all the same.
""",
        ("island demo", "the s-curve, about a minute"),
        ("island demo --course u-turn --period 0.03", "another course, at Autoware's own period"),
        ("island demo --target freertos_posix", "with CAN output: frames beside the commands"),
        ("island demo --duration 0", "lap after lap, until q or Ctrl-C"),
        ("island demo --log drive.csv --plot drive.svg", "with a table and a picture of the drive"),
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
    parser.add_argument(
        "--domain-tag",
        metavar="TAG",
        help="tag of the island's domain: who has another one, or none, is no part of it",
    )
    parser.add_argument(
        "--log",
        type=Path,
        metavar="FILE",
        help="write the drive as CSV, ten rows a second, with units in the header",
    )
    parser.add_argument(
        "--plot",
        type=Path,
        metavar="FILE",
        help="write a picture of the drive as SVG: path, lateral error, speed, angle, guard",
    )
    parser.add_argument(
        "--plain", action="store_true", help="plain lines instead of a live view, no keys"
    )
    parser.add_argument(
        "--no-page", action="store_true", help="serve no page for the browser (nor with --json)"
    )
    parser.add_argument(
        "--no-open",
        action="store_true",
        help="print the page's address alone; else a terminal on a desktop opens it too",
    )
    options.add_json(parser, "the summary")


def execute(arguments: argparse.Namespace) -> int:
    """Run the demo; 0 when all went well."""
    if arguments.domains is not None and len(set(arguments.domains)) == 1:
        raise UsageError("--domains: found the same domain twice; a bridge needs two")
    # a mistake is told before anything starts
    parameters = read_parameters(arguments.params, arguments.period).parameters
    if arguments.plot is not None:
        open_output(arguments.plot).close()
    with Recorder(arguments.log, keep=arguments.plot is not None) as recorder:
        _prepare()
        wanted = pairs_from(*DOMAINS) if arguments.domains is None else [tuple(arguments.domains)]
        with reserve(wanted) as pair:
            if pair is None:
                raise IslandError(_in_use(arguments.domains))
            if arguments.domains is None and pair != DOMAINS:
                _note(
                    "DDS domains 1 and 2 are in use on this machine;"
                    f" taking {pair[0]} and {pair[1]}"
                )
            return _run(arguments, parameters, (pair[0], pair[1]), recorder)


def _run(
    arguments: argparse.Namespace,
    parameters: IslandParameters,
    domains: tuple[int, int],
    recorder: Recorder,
) -> int:
    stop = _Interrupt()
    before = usage()
    with TemporaryDirectory() as folder:
        recipe = _Recipe(arguments, domains, Path(folder))
        has_keys = _has_keys(arguments)
        limit_s = arguments.duration + GRACE_S if arguments.duration else math.inf
        with _display(arguments, domains, has_keys=has_keys) as show:
            children = [recipe.island(), recipe.bridge(), recipe.vehicle()]
            if recipe.has_page:
                children.append(recipe.page())
            session = Session(children, show, limit_s, stop)
            session.state.on_status.append(recorder)
            session.opens_page = has_keys and not arguments.no_open
            _connect(session, recipe, parameters)
            with ExitStack() as stack:
                if has_keys and isinstance(show, TerminalShow):
                    keyboard = Keyboard(sys.stdin.fileno(), show.suspend, show.resume)
                    session.keyboard = stack.enter_context(keyboard)
                session.run()
    state = session.state
    if arguments.plot is not None:
        title = f"island demo: {arguments.course}"
        _write(arguments.plot, plot(recorder.rows, state.events, title))
    if stop.is_set() and not state.has_driven:
        return _nothing_to_judge(stop, state, arguments.json)
    found = conditions(state, stop.is_set(), other_work(before, usage()))
    _tell(found, state, arguments.json)
    if stop.was_signal and arguments.duration:
        return 128 + signal.SIGINT
    return 1 if any(condition.holds is False for condition in found) else 0


class _Interrupt(StopFlag):
    """Set by a signal that asks to end, or by a key."""

    def __init__(self) -> None:
        super().__init__()
        self.was_signal = False
        for number in stop_signals():
            signal.signal(number, self._on_signal)

    def _on_signal(self, *_: object) -> None:
        self.was_signal = True
        self.set()


class _Recipe:
    """Makes the processes of the demo, not started."""

    def __init__(
        self, arguments: argparse.Namespace, domains: tuple[int, int], folder: Path
    ) -> None:
        self._arguments, self._folder = arguments, folder
        self._domains = domains
        self.has_page = not (arguments.no_page or arguments.json)

    def island(self, name: str = ISLAND) -> Child:
        """The safety island, or another one of that name."""
        given = self._arguments
        domain, tag = self._domains[1], given.domain_tag
        settings = (domain, given.params, given.period, given.target, tag, name)
        return island_child(*settings)

    def page(self) -> Child:
        """The monitor that serves the page."""
        given = self._arguments
        return page_child(self._domains[1], given.params, given.domain_tag)

    def second_island(self) -> Child:
        """A second island on the island's domain."""
        return self.island(SECOND_ISLAND)

    def bridge(self) -> Child:
        """The bridge."""
        return bridge_child(self._domains, self._folder, self._arguments.domain_tag)

    def vehicle(self) -> Child:
        """The main compute."""
        return vehicle_child(self._domains[0], self._arguments.course, self._arguments.duration)

    def arm(self) -> Child:
        """The request to arm."""
        return arm_child(self._domains[1], self._arguments.domain_tag)


def _connect(session: Session, recipe: _Recipe, parameters: IslandParameters) -> None:
    """Let keys and buttons act, and show what comes of it."""
    actions = Actions(session, Recipes(recipe.bridge, recipe.second_island, recipe.arm))
    reactions = Reactions(session.state, parameters)
    page = PageLines(session, actions.buttons)

    def on_keys(keys: str) -> None:
        for key in keys:
            now = time.monotonic()
            if actions.press(key):
                reactions.pressed(-math.inf if key == "q" else now)

    def on_button(name: str) -> None:
        now = time.monotonic()
        if actions.click(name):
            reactions.pressed(now)

    def look(now: float) -> None:
        reactions.look(now)
        page.look()

    session.on_keys, session.on_button, session.look = on_keys, on_button, look


def _has_keys(arguments: argparse.Namespace) -> bool:
    """Whether the live view is shown to somebody who has a keyboard."""
    return not (arguments.json or arguments.plain) and sys.stdout.isatty() and sys.stdin.isatty()


def _display(
    arguments: argparse.Namespace, domains: tuple[int, int], *, has_keys: bool
) -> PlainShow | TerminalShow:
    if arguments.json:
        return PlainShow(sys.stderr)
    if arguments.plain or not sys.stdout.isatty():
        return PlainShow(sys.stdout)
    title = f"safety island — {arguments.course} — domains {domains[0]} and {domains[1]}"
    course = load_course(arguments.course)
    if arguments.duration:
        course, _ = fit(course, arguments.duration)  # as the main compute drives it
    return TerminalShow(course, title, has_keys=has_keys)


def _write(path: Path, text: str) -> None:
    with open_output(path) as file:
        file.write(text)


def _nothing_to_judge(stop: _Interrupt, state: DemoState, as_json: bool) -> int:
    """Say that the demo was ended during its start; return the exit code."""
    if as_json:
        print(json.dumps(_summary([], state) | {"ok": None}, indent=2))
    else:
        print("ended during the start: nothing was driven, so there is nothing to judge")
    return 128 + signal.SIGINT if stop.was_signal else 0


def _tell(found: list[Condition], state: DemoState, as_json: bool) -> None:
    if as_json:
        print(json.dumps(_summary(found, state), indent=2))
        return
    for condition in found:
        text = condition.text.replace("\n", "\n" + " " * 8)
        print(f"{condition.verdict:>6}  {text}")
    if state.first_control_s is not None:
        print(f"        first Control {state.first_control_s:.2f} s after the island's start")


def _summary(found: list[Condition], state: DemoState) -> dict[str, object]:
    return {
        "ok": all(condition.holds is not False for condition in found),
        "conditions": {condition.name: condition.holds for condition in found},
        "first_control_s": state.first_control_s,
        "vehicle": state.vehicle_summary,
        "island": state.island_summary,
        "forwarded": state.forwarded,
    }


def _prepare() -> None:
    """Compile ahead of the processes, so that all can see what is going on."""
    from safety_island.cli.progress import prepare_kernels
    from safety_island.kernel import kernel
    from safety_island.kernel.entries import all_entries

    all_entries()
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
