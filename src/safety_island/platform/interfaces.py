# SPDX-License-Identifier: Apache-2.0
"""What the island asks of the machine below it: small interfaces, and the values they pass.

A port to another machine replaces the backends of these and nothing else. Only this room reads a
clock, waits, or touches a device; everything above is told the time.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from enum import IntEnum
from ipaddress import IPv4Address, IPv4Interface
from typing import NamedTuple, Protocol

from safety_island.errors import IslandError


class NetworkError(IslandError):
    """An interface that did not get an IPv4 address within its limit."""


class CanError(IslandError):
    """A CAN device that cannot be opened."""


class LogLevel(IntEnum):
    """``CONFIG_LOG_LEVEL``: how much is logged."""

    NONE = 0
    NORMAL = 1
    DEBUG = 2


@dataclass(frozen=True)
class LogConfig:
    """What is logged and how; the throttle interval is in seconds, the capacity in lines."""

    level: LogLevel = LogLevel.NORMAL
    throttle_s: float = 3.0
    json: bool = False
    capacity: int = 1024


class Clock(Protocol):
    """Two clocks: a monotonic one that schedules and ages, a wall clock that only stamps."""

    def monotonic_ns(self) -> int:
        """Time [ns] since an arbitrary start; never goes back."""

    def wall_ns(self) -> int:
        """Wall clock [ns since 1970]; may jump."""

    def now(self) -> float:
        """Wall clock [s since 1970], as a message stamp in seconds."""

    def slept_ns(self) -> int:
        """Time [ns] for which the machine was suspended; the monotonic clock stood still."""

    def set_wall_offset_ns(self, offset_ns: int | None) -> None:
        """Let the wall clock be the monotonic one plus this; None: the machine's own wall clock."""


class Tick(NamedTuple):
    """One tick of a timer that is due now."""

    due_ns: int
    """Its place on the grid, monotonic [ns]."""
    lateness_ns: int
    """How long after that place it starts; at most half a period."""
    skipped: int
    """Ticks that were missed since the tick before this one."""


class Timer(Protocol):
    """Ticks on a fixed grid of the monotonic clock; the first is one period after the start."""

    @property
    def period_ns(self) -> int:
        """Distance [ns] of two places on the grid."""

    @property
    def ticks(self) -> int:
        """Ticks that were given out."""

    @property
    def skipped(self) -> int:
        """Ticks that were missed, in all."""

    def wait(self) -> Tick | None:
        """Wait for the next tick; None when ``wake`` was called.

        A tick that would start more than half a period late is skipped and counted, so two ticks
        are never closer than half a period: no burst follows a delay.
        """

    def wake(self) -> None:
        """End the present wait, or the next one, at once; may be called by a signal handler."""

    def close(self) -> None:
        """Give back what the timer holds."""


class Logger(Protocol):
    """Log lines that never make the caller wait."""

    level: LogLevel

    @property
    def dropped(self) -> int:
        """Lines that found the queue full or whose sink failed."""

    def error(self, text: str, *values: object, throttled: bool = False, site: str = "") -> None:
        """Log what keeps the island from its work; ``values`` fill ``text`` as with ``%``."""

    def warning(self, text: str, *values: object, throttled: bool = False, site: str = "") -> None:
        """Log what a user should look at."""

    def info(self, text: str, *values: object, throttled: bool = False, site: str = "") -> None:
        """Log an event of normal operation."""

    def debug(self, text: str, *values: object, throttled: bool = False, site: str = "") -> None:
        """Log what only a developer wants; shown at level DEBUG alone.

        A throttled line is logged once in an interval by each call site. A call site that serves
        several subjects names each with ``site``; without it the file and the line are the name.
        """

    def flush(self, timeout_s: float = 1.0) -> bool:
        """Wait until the lines so far are written; False when the time ran out."""

    def close(self) -> None:
        """Write what is queued, within a short limit, and end."""


class Network(Protocol):
    """The interfaces of the machine."""

    def address(self, interface: str) -> str | None:
        """IPv4 address of the interface; None when it has none, is down or does not exist."""

    def describe(self, interface: str) -> str:
        """What is known of the interface, in a few words for an error message."""

    def configure(
        self,
        interface: str,
        vlan: int,
        address: IPv4Interface | None,
        gateway: IPv4Address | None,
    ) -> str:
        """Give an interface, or a VLAN of it (id 1 to 4094), an address and a default route.

        Returns the name of what carries the address. What is there already is left as it is.
        Raises NetworkError.
        """

    def wait_for_address(
        self, interface: str, limit_s: float, stopped: Callable[[], bool] = ...
    ) -> str | None:
        """IPv4 address of the interface, as soon as it has one; None when ``stopped()``.

        Raises NetworkError after the limit.
        """


class CanFrame(NamedTuple):
    """One classic CAN frame with a standard (11-bit) identifier and up to 8 bytes."""

    arbitration_id: int
    data: bytes


class CanResult(IntEnum):
    """What became of a frame."""

    SENT = 0
    QUEUE_FULL = 1
    TIMED_OUT = 2
    BUS_OFF = 3
    INTERFACE_DOWN = 4
    NOT_OPEN = 5
    FAILED = 6


class CanDevice(Protocol):
    """One CAN controller that frames are sent with."""

    def open(self) -> None:
        """Make the device ready. Raises CanError."""

    def send(self, frame: CanFrame, budget_s: float) -> CanResult:
        """Hand a frame to the controller, waiting at most ``budget_s``; failure is a value."""

    def close(self) -> None:
        """Give the device back; a second call does nothing."""


@dataclass(frozen=True)
class Platform:
    """One backend of every interface, as ``load`` returns it."""

    name: str
    clock: Clock
    logger: Logger
    network: Network
    new_timer: Callable[[float], Timer]
    """Make a timer with a period [s]."""
    new_can: Callable[[str], CanDevice]
    """Make the CAN device of that name."""
    memory_bytes: Callable[[], int]
    """Resident set size of the process [byte]; 0 where it is not known."""
    on_stop: Callable[[Callable[[], None]], AbstractContextManager[None]]
    """Call a function when the process is told to stop, as long as the context lasts."""
