# SPDX-License-Identifier: Apache-2.0
"""The machine below the island: clock, timer, logger, network and CAN device, with backends.

A backend is a row in ``BACKENDS`` and a folder with the same file names; it is imported when it is
chosen. Imports: the standard library, and pyroute2 where an interface is configured.
"""

from __future__ import annotations

from importlib import import_module

from safety_island.errors import ConfigurationError
from safety_island.platform.interfaces import (
    CanDevice,
    CanError,
    CanFrame,
    CanResult,
    Clock,
    LogConfig,
    Logger,
    LogLevel,
    Network,
    NetworkError,
    Platform,
    Tick,
    Timer,
)

__all__ = [
    "BACKENDS",
    "CanDevice",
    "CanError",
    "CanFrame",
    "CanResult",
    "Clock",
    "LogConfig",
    "LogLevel",
    "Logger",
    "Network",
    "NetworkError",
    "Platform",
    "Tick",
    "Timer",
    "load",
]

BACKENDS = {
    "posix": "safety_island.platform.posix",
    "sim": "safety_island.platform.sim",
}
"""Name of a platform -> the package that builds it with ``make(log)``."""


def load(name: str, log: LogConfig | None = None) -> Platform:
    """Return the platform of that name. Raises ConfigurationError when there is none."""
    if name not in BACKENDS:
        raise ConfigurationError(
            f"platform '{name}' is unknown: choose one of {', '.join(sorted(BACKENDS))}"
        )
    platform: Platform = import_module(BACKENDS[name]).make(log or LogConfig())
    return platform
