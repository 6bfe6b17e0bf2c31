# SPDX-License-Identifier: Apache-2.0
"""The platform of an ordinary Linux machine: real time, real sockets."""

from __future__ import annotations

from safety_island.platform.interfaces import LogConfig, Platform
from safety_island.platform.posix.can import SocketCan
from safety_island.platform.posix.clock import PosixClock
from safety_island.platform.posix.logger import PosixLogger
from safety_island.platform.posix.network import PosixNetwork
from safety_island.platform.posix.process import memory_bytes, on_stop
from safety_island.platform.posix.timer import PosixTimer


def make(log: LogConfig) -> Platform:
    """Return the platform; its logger writes to standard error."""
    clock = PosixClock()
    return Platform(
        name="posix",
        clock=clock,
        logger=PosixLogger(clock, log),
        network=PosixNetwork(clock),
        new_timer=lambda period_s: PosixTimer(clock, period_s),
        new_can=SocketCan,
        memory_bytes=memory_bytes,
        on_stop=on_stop,
    )
