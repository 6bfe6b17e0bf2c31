# SPDX-License-Identifier: Apache-2.0
"""The orderly start of ``island run``: network first, then time."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from safety_island.cli.run_settings import RunSettings
from safety_island.dds.config import DdsConfig
from safety_island.platform import Platform


@contextmanager
def thread_stacks(size: int) -> Iterator[None]:
    """Give each thread that Python starts meanwhile a stack of that size [bytes]."""
    before = threading.stack_size(size)
    try:
        yield
    finally:
        threading.stack_size(before)


def bring_up(platform: Platform, settings: RunSettings) -> DdsConfig:
    """Configure the interfaces, wait for the address of DDS's own, set the wall clock.

    Returns the DDS configuration, on a VLAN when there is one. Raises NetworkError, SntpError.
    """
    dds = settings.dds
    for item in settings.interfaces:
        name = platform.network.configure(item.name, item.vlan, item.address, item.gateway)
        platform.logger.info("interface '%s': %s", name, platform.network.describe(name))
        if item.name == dds.interface:
            dds = replace(dds, interface=name)
    if dds.interface is not None:
        _wait_for_address(platform, dds.interface, settings.address_limit_s)
    if settings.sntp_server is not None:
        _set_time(platform, settings.sntp_server)
    return dds


def _wait_for_address(platform: Platform, interface: str, limit_s: float) -> None:
    network = platform.network
    if network.address(interface) is None:
        platform.logger.info(
            "waiting at most %g s for an IPv4 address of interface '%s' (%s)",
            limit_s,
            interface,
            network.describe(interface),
        )
    address = network.wait_for_address(interface, limit_s)
    platform.logger.info("interface '%s' has the IPv4 address %s", interface, address)


def _set_time(platform: Platform, server: str) -> None:
    from safety_island.platform.posix.sntp import synchronise

    clock = platform.clock
    before_ns = clock.wall_ns()
    reply = synchronise(clock, server)
    platform.logger.info(
        "wall clock set by SNTP server '%s' (stratum %d), good to %.3f ms; it moved by %+.3f s",
        server,
        reply.stratum,
        reply.round_trip_ns / 2e6,
        (clock.wall_ns() - before_ns) / 1e9,
    )
