# SPDX-License-Identifier: Apache-2.0
"""What only SocketCAN can tell: frames that the kernel holds back, and a bus that is off."""

from __future__ import annotations

import socket
import struct
from contextlib import suppress
from pathlib import Path

from safety_island.command.frames import WATCHED_IDS
from safety_island.platform.interfaces import CanError

COMMAND_FILTERS = [{"can_id": i, "can_mask": 0x7FF, "extended": False} for i in sorted(WATCHED_IDS)]
"""Kernel filters for the identifiers that are ours; error frames pass them."""

INTERFACES = Path("/sys/class/net")

# getsockopt: the memory of a socket's frames that have not left yet (linux/sock_diag.h, 4.12).
_SO_MEMINFO = 55
_MEMINFO = struct.Struct("=9I")
_WMEM_ALLOC = 2


def is_held_back(raw: socket.socket) -> bool:
    """Tell whether the kernel still holds frames that were sent with this socket."""
    try:
        info = raw.getsockopt(socket.SOL_SOCKET, _SO_MEMINFO, _MEMINFO.size)
    except OSError:  # an older kernel
        return False
    return bool(_MEMINFO.unpack(info)[_WMEM_ALLOC])


def refuse_without_carrier(channel: str, interfaces: Path = INTERFACES) -> None:
    """Raise CanError when the interface is up and has no carrier, as after bus-off.

    Opening a socket there succeeds, and the frames would wait for a restart.
    """
    with suppress(OSError):  # down, or not there: opening the socket says so
        if (interfaces / channel / "carrier").read_text().strip() == "0":
            raise CanError(
                f"CAN bus 'socketcan:{channel}' cannot be opened: the controller is off the bus; "
                f"'ip link set {channel} type can restart-ms 100' lets the kernel restart it"
            )
