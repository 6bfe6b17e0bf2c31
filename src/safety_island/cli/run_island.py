# SPDX-License-Identifier: Apache-2.0
"""What ``island run`` does: settings, network, time, CAN, DDS, kernels, then ticks."""

from __future__ import annotations

import argparse
from contextlib import ExitStack
from typing import NamedTuple

from safety_island.cli.configuration import chosen
from safety_island.cli.jsonlines import JsonLines
from safety_island.cli.parameters import read_parameters
from safety_island.cli.process import seconds_since_start
from safety_island.cli.progress import prepare_kernels
from safety_island.cli.run_can import CanSide
from safety_island.cli.run_report import RunReport
from safety_island.cli.run_service import service
from safety_island.cli.run_settings import RunSettings, run_settings
from safety_island.cli.run_start import bring_up, thread_stacks
from safety_island.cli.stopping import StopAtOnce
from safety_island.cli.tell import LOST
from safety_island.cli.virtual import VirtualVehicle, course_of
from safety_island.control.follower import TrajectoryFollower
from safety_island.dds.config import URI, DdsConfig, user_xml
from safety_island.kernel.records import Records
from safety_island.node import ControllerNode, open_transport
from safety_island.node.controller import NAME
from safety_island.params import IslandParameters, notes
from safety_island.platform import Platform, load
from safety_island.sim.courses import Course


class Run(NamedTuple):
    """What a run is made of."""

    platform: Platform
    settings: RunSettings
    parameters: IslandParameters
    arguments: argparse.Namespace
    course: Course | None = None
    """What the vehicle of virtual time drives."""


def run(arguments: argparse.Namespace, start: StopAtOnce) -> None:
    """Start in order and run until told to stop. Raises IslandError when the start fails."""
    settings = run_settings(arguments, chosen(arguments))
    course = course_of(arguments) if arguments.platform == "sim" else None
    parameters = read_parameters(arguments.params, arguments.period).parameters
    with thread_stacks(settings.thread_stack_size), ExitStack() as stack:
        platform = load(arguments.platform, settings.log)
        stack.callback(platform.logger.close)
        _start(Run(platform, settings, parameters, arguments, course), start, stack)


def _start(run: Run, start: StopAtOnce, stack: ExitStack) -> None:
    platform, settings, parameters = run.platform, run.settings, run.parameters
    arguments = run.arguments
    for note in notes(parameters):
        platform.logger.info("%s", note)
    dds = bring_up(platform, settings)
    can = CanSide(platform, settings, parameters.node.ctrl_period)
    stack.callback(can.close)
    # Discovery goes on while the kernels are loaded.
    joined_at = platform.clock.monotonic_ns() / 1e9
    transport = open_transport(platform, settings.domain_id, dds, NAME)
    stack.callback(transport.close)
    prepare_kernels()
    follower = _follower(run)
    node = ControllerNode(
        platform,
        transport,
        follower,
        parameters,
        outputs=(),
        mode=settings.mode,
        joined_at=joined_at,
        where="" if platform.name == "sim" else where(settings.domain_id, dds),
    )
    node.sender.outputs = can.outputs(node)
    if arguments.debug_topics:
        from safety_island.node.debug import DebugTopics

        node.observers.append(DebugTopics(node))
    _drive(run, node, follower.trace, can, start)


def where(domain_id: int, dds: DdsConfig) -> str:
    """Name a domain, and its interface or what chooses that."""
    chosen_by = dds.interface or "the DDS library's interface"
    return f"domain {domain_id} ({URI if user_xml() is not None else chosen_by})"


def _follower(run: Run) -> TrajectoryFollower:
    """Return the controllers; those of the debug topics are the same, with readable memory."""
    if not run.arguments.debug_topics:
        return TrajectoryFollower(run.parameters)
    from safety_island.node.debug import ObservedFollower

    return ObservedFollower(run.parameters)


def _json_lines(platform: Platform, node: ControllerNode) -> JsonLines:
    """Return what writes the ticks; a reader that has gone ends nothing but a virtual drive."""
    if platform.name == "sim":
        return JsonLines(lambda reason: node.stop(), patient=True)
    return JsonLines(lambda reason: platform.logger.warning(LOST, reason))


def _drive(run: Run, node: ControllerNode, trace: Records, can: CanSide, start: StopAtOnce) -> None:
    """Tick until told to stop, then close the node and tell how it went."""
    platform, settings, parameters, arguments, course = run
    lines = _json_lines(platform, node) if arguments.json else None
    side = can if settings.mode.uses_can else None
    report = RunReport(node, trace, seconds_since_start, lines, side)
    node.observers.append(report)
    vehicle = None
    if course is not None:
        vehicle = VirtualVehicle(platform, node.transport, node.stop, course)
    with node, platform.on_stop(node.stop), service(platform, arguments, node):
        start.disarm()
        node.run(parameters.node.ctrl_period, arguments.duration or None)
        report.finish()
        if vehicle is not None:
            vehicle.finish(lines)
        node.close()
