"""``island run``: the safety island itself."""

from __future__ import annotations

import argparse

from safety_island.cli import options
from safety_island.cli.jsonlines import JsonLines
from safety_island.cli.parameters import read_parameters
from safety_island.cli.parser import teach
from safety_island.cli.process import seconds_since_start
from safety_island.cli.stopping import StopAtOnce


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    teach(
        parser,
        """
Run the safety island: subscribe to trajectory, odometry, acceleration, steering and operation
mode, and publish a control command every period. Stop it with Ctrl-C or SIGTERM: it finishes its
tick, leaves the domain and exits 0.
""",
        ("island run", "domain 2 on this machine, 150 ms, the default parameters"),
        ("island run --interface tap0 --period 0.03", "on a network, at Autoware's own period"),
        (
            "island run --params firmware my/pid.param.yaml",
            "the firmware's values, a file over them",
        ),
        ("island run --duration 10 --json", "ten seconds, every tick as a JSON line"),
    )
    options.add_domain(parser, 2, "the safety island")
    options.add_params(parser)
    options.add_period(parser)
    options.add_interface(parser)
    parser.add_argument(
        "--platform",
        choices=("posix", "sim"),
        default="posix",
        help="posix: this machine, on DDS; sim: virtual time and topics in memory, with a "
        "simulated vehicle on the s-curve (default: posix)",
    )
    options.add_duration(parser, 0.0)
    options.add_json(parser, "every tick")


def execute(arguments: argparse.Namespace) -> int:
    """Run until told to stop."""
    with StopAtOnce() as start:
        _run(arguments, start)
    return 0


def _run(arguments: argparse.Namespace, start: StopAtOnce) -> None:
    parameters = read_parameters(arguments.params, arguments.period).parameters
    from safety_island.cli.progress import prepare_kernels
    from safety_island.cli.run_report import RunReport
    from safety_island.control.follower import TrajectoryFollower
    from safety_island.dds.config import DdsConfig
    from safety_island.node import ControllerNode, open_transport
    from safety_island.node.controller import NAME
    from safety_island.params import notes
    from safety_island.platform import load

    platform = load(arguments.platform)
    for note in notes(parameters):
        platform.logger.info("%s", note)
    # Discovery goes on while the kernels are loaded.
    config = DdsConfig(interface=arguments.interface)
    transport = open_transport(platform, arguments.domain, config, NAME)
    prepare_kernels()
    follower = TrajectoryFollower(parameters)
    lines = JsonLines(patient=platform.name == "sim") if arguments.json else None
    with ControllerNode(platform, transport, follower, parameters.node) as node:
        report = RunReport(node, follower.trace, seconds_since_start, lines)
        node.observers.append(report)
        vehicle = None
        if platform.name == "sim":
            from safety_island.cli.virtual import VirtualVehicle

            vehicle = VirtualVehicle(platform, transport, node.stop)
        with platform.on_stop(node.stop):
            start.disarm()
            node.run(parameters.node.ctrl_period, arguments.duration or None)
            report.finish()
            if vehicle is not None:
                vehicle.finish(lines)
            node.close()
    platform.logger.close()
