# SPDX-License-Identifier: Apache-2.0
"""``island main-compute``: a planner and a vehicle in place of Autoware."""

from __future__ import annotations

import argparse

from safety_island.cli import options
from safety_island.cli.jsonlines import JsonLines
from safety_island.cli.parser import UsageError, teach
from safety_island.cli.stopping import StopAtOnce, StopFlag
from safety_island.cli.tell import tell, tell_lost
from safety_island.sim.courses import COURSES, DEFAULT_COURSE


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    courses = "; ".join(f"{name}: {summary}" for name, summary in COURSES.items())
    teach(
        parser,
        """
Stand in for Autoware: publish a trajectory at 10 Hz, and odometry, acceleration and steering of a
simulated vehicle at 40 Hz; drive it by the control commands that come back. Autonomous mode is
engaged when commands come. When they stop coming the vehicle brakes, as Autoware would see to.
""",
        ("island main-compute", "the s-curve on domain 1, once"),
        ("island main-compute --course slalom --repeat", "another course, lap after lap"),
        ("island main-compute --json", "where the vehicle is, ten times a second"),
    )
    options.add_domain(parser, 1, "the main compute")
    parser.add_argument(
        "--course",
        choices=tuple(COURSES),
        default=DEFAULT_COURSE,
        help=f"{courses} (default: {DEFAULT_COURSE})".replace("%", "%%"),
    )
    parser.add_argument("--repeat", action="store_true", help="drive lap after lap")
    parser.add_argument(
        "--within",
        type=options.duration_s,
        default=0.0,
        metavar="SECONDS",
        help="drive about this long: as many laps as fit, or a part of the course",
    )
    parser.add_argument("--no-engage", action="store_true", help="leave the operation mode at STOP")
    parser.add_argument(
        "--console",
        action="store_true",
        help="obey lines on standard input: engage, disengage, stay (engaged when commands stop "
        "coming, as Autoware does), nan and number (the odometry), jump and return (the "
        "trajectory), freeze TOPIC, thaw TOPIC, end; the topics go on after the drive, until the "
        "input is closed",
    )
    options.add_network(parser)
    options.add_duration(parser, 0.0)
    options.add_json(parser, "status and summary")


def execute(arguments: argparse.Namespace) -> int:
    """Drive until the course is driven, time is up, or told to stop."""
    if arguments.repeat and arguments.within:
        raise UsageError(
            "--within: --repeat drives without end; drop one, or end the time with --duration"
        )
    with StopAtOnce() as start:
        from safety_island.platform import load
        from safety_island.sim.console import Console
        from safety_island.sim.main_compute import MainComputeOptions, run

        chosen = MainComputeOptions(
            domain=arguments.domain,
            course=arguments.course,
            repeat=arguments.repeat,
            engage=not arguments.no_engage,
            duration_s=arguments.duration,
            within_s=arguments.within,
            dds=options.dds_config(arguments),
        )
        platform, stop = load("posix"), StopFlag()
        report = JsonLines(tell_lost).write if arguments.json else None
        with platform.on_stop(stop.set):
            start.disarm()
            console = Console(tell) if arguments.console else None
            return run(chosen, stop, platform.clock, report, tell, console)
