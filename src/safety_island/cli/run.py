# SPDX-License-Identifier: Apache-2.0
"""``island run``: the safety island itself."""

from __future__ import annotations

import argparse

from safety_island.cli import configuration, options
from safety_island.cli.parser import teach
from safety_island.cli.stopping import StopAtOnce


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    teach(
        parser,
        """
Run the safety island: subscribe to trajectory, odometry, acceleration, steering and operation
mode, and send a control command every period, over DDS, CAN or both. The configuration is that of
the target (see 'island config'); options win over it. The start waits for the address of the
network interface. Stop it with Ctrl-C, SIGTERM or SIGHUP: it finishes its tick, closes CAN and
DDS, and exits 0. With CAN_ONLY it stops a moving vehicle first, also at the end of --duration; a
second signal ends it at once.
""",
        ("island run", "domain 2 on this machine, 150 ms, the default parameters"),
        ("island run --interface tap0 --period 0.03", "on a network, at Autoware's own period"),
        (
            "island run --params firmware my/pid.param.yaml",
            "the firmware's values, a file over them",
        ),
        ("island run -t freertos_posix", "as the simulator: DDS, and CAN frames in memory"),
        ("island run --can socketcan:can0 --can-log drive.log", "DDS and a real bus, with a log"),
        ("island run --duration 10 --json", "ten seconds, every tick as a JSON line"),
        (
            "island run --platform sim --course slalom",
            "a drive in virtual time, in a second or two",
        ),
    )
    configuration.add_target(parser, "posix")
    configuration.add_configuration(parser)
    options.add_params(parser)
    options.add_period(parser)
    _add_network(parser)
    _add_can(parser)
    parser.add_argument(
        "--platform",
        choices=("posix", "sim"),
        default="posix",
        help="posix: this machine, on DDS; sim: virtual time and topics in memory, with a "
        "simulated vehicle (default: posix)",
    )
    parser.add_argument(
        "--course",
        metavar="NAME",
        help="with --platform sim: what the vehicle drives, one of the courses that 'island "
        "main-compute --help' lists (default: s-curve)",
    )
    parser.add_argument(
        "--path",
        metavar="FILE",
        help="with --platform sim: a path of your own, CSV with the columns x,y,yaw,v (yaw and v "
        "may be left out) or YAML with a list for each; m, rad, m/s",
    )
    options.add_realtime(parser)
    options.add_duration(parser, 0.0)
    options.add_json(parser, "every tick")
    parser.add_argument(
        "--debug-topics",
        action="store_true",
        help="publish what Autoware's own tools and RViz look at: predicted trajectory, horizon of "
        "commands, numbers of both controllers, /diagnostics (docs/topics.md)",
    )
    parser.add_argument("--log-json", action="store_true", help="log lines as JSON objects")


def _add_network(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--domain",
        type=options.domain_id,
        metavar="ID",
        help="DDS domain of the safety island (default: DDS_DOMAIN_ID of the configuration, 2)",
    )
    parser.add_argument(
        "--interface",
        type=options.interface,
        metavar="NAME",
        help="network interface, for example eth0 or tap0 (default: DDS_NETWORK_INTERFACE of the "
        "configuration; posix: lo, this machine only; CYCLONEDDS_URI, when set, configures DDS "
        "instead)",
    )
    options.add_peers_and_tag(parser)
    options.add_library(parser)
    parser.add_argument(
        "--sntp",
        metavar="SERVER",
        help="set the wall clock of the island, not of the machine, by this SNTP server "
        "(HOST or HOST:PORT); no answer ends the start",
    )


def _add_can(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--mode",
        choices=("DDS_ONLY", "CAN_ONLY", "DDS_AND_CAN"),
        help="where commands go (default: CONTROL_CMD_OUTPUT_... of the configuration)",
    )
    parser.add_argument(
        "--can",
        metavar="BUS",
        help="CAN bus, for example socketcan:can0, udp_multicast:239.74.163.2 or mock (default: "
        "CAN_DEVICE of the configuration); without --mode it adds CAN to DDS",
    )
    parser.add_argument(
        "--can-log", metavar="FILE", help="write each frame that is sent, as 'candump -L' does"
    )


def execute(arguments: argparse.Namespace) -> int:
    """Run until told to stop."""
    with StopAtOnce() as start:
        from safety_island.cli.run_island import run

        rejoin = run(arguments, start)
    if rejoin.is_due:
        rejoin.start_again()
    return 0
