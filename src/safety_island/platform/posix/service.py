# SPDX-License-Identifier: Apache-2.0
"""What a service manager is told, in the protocol of systemd's ``sd_notify``."""

from __future__ import annotations

import os
import socket
import time
from contextlib import suppress

VARIABLE = "NOTIFY_SOCKET"
"""Names the manager's socket: a path, or an abstract name after ``@``."""
WATCHDOG = "WATCHDOG_USEC"
"""After how long without a sign of life [us] the manager starts the process anew."""
LONGEST_INTERVAL_S = 0.1
"""Least time [s] between two signs of life, or a quarter of the watchdog's, so that a loop that
turns ten thousand times a second does not keep the manager busy."""


class ServiceManager:
    """The manager that started this process; without one nothing is sent.

    Sending never waits: a manager that does not read misses a message, and what it misses for
    longer than its watchdog allows is a reason to start anew.
    """

    def __init__(self, address: str | None = None) -> None:
        """``address``: of the socket (None: what the environment names)."""
        named = os.environ.get(VARIABLE, "") if address is None else address
        self._socket: socket.socket | None = None
        self._address = f"\0{named[1:]}" if named.startswith("@") else named
        watchdog_us = os.environ.get(WATCHDOG, "")
        quarter_s = int(watchdog_us) / 4e6 if watchdog_us.isdigit() else LONGEST_INTERVAL_S
        self._interval_s = min(quarter_s, LONGEST_INTERVAL_S)
        self._next = 0.0
        if named:
            self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
            self._socket.setblocking(False)

    def ready(self) -> None:
        """Tell that the start is over."""
        self._send(b"READY=1")

    def alive(self) -> None:
        """Tell that the work goes on, now and then; call it in every round of the work."""
        if self._socket is not None and (now := time.monotonic()) >= self._next:
            self._next = now + self._interval_s
            self._send(b"WATCHDOG=1")

    def stopping(self) -> None:
        """Tell that the end has begun."""
        self._send(b"STOPPING=1")

    def close(self) -> None:
        """Give the socket back."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def _send(self, message: bytes) -> None:
        if self._socket is not None:
            with suppress(OSError):
                self._socket.sendto(message, self._address)
