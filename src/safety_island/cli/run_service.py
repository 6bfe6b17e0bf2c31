# SPDX-License-Identifier: Apache-2.0
"""What ``island run`` is to the machine: a real-time process, and a service with a watchdog."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager

from safety_island.cli.run_rejoin import IslandRejoin
from safety_island.node import ControllerNode, Outcome, TickReport
from safety_island.platform import Platform


@contextmanager
def service(
    platform: Platform, arguments: argparse.Namespace, node: ControllerNode, rejoin: IslandRejoin
) -> Iterator[None]:
    """Take real-time scheduling, tell the service manager "ready", and of each tick without fault.

    Silence is no fault: an island that waits for inputs is well. Does nothing in virtual time.
    Raises RealTimeError.
    """
    if platform.name == "sim":
        yield
        return
    from safety_island.platform.posix.real_time import ISLAND, take_real_time
    from safety_island.platform.posix.service import ServiceManager

    manager = ServiceManager()

    def watch(report: TickReport) -> None:
        if report.outcome is not Outcome.FAULT:
            manager.alive()

    node.observers.append(watch)
    result = take_real_time(arguments.realtime, arguments.cpu, ISLAND)
    if result is not None:
        platform.logger.info("%s", result)
    manager.ready()
    yield
    if not rejoin.is_due:  # the process goes on as another one
        manager.stopping()
    manager.close()
