# SPDX-License-Identifier: Apache-2.0
"""Autoware's trajectory follower on a safety island: MPC and PID over DDS and CAN.

``from safety_island import drive, load_course``: the Python interface is that of
``safety_island.api``, which is loaded when one of its names is first used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from safety_island.api import (
        COURSES,
        Command,
        Controller,
        Course,
        Drive,
        IslandError,
        Parameters,
        Vehicle,
        drive,
        load_course,
        load_parameters,
        make_course,
        read_course,
    )

__version__ = "0.2.0"

__all__ = [
    "COURSES",
    "Command",
    "Controller",
    "Course",
    "Drive",
    "IslandError",
    "Parameters",
    "Vehicle",
    "__version__",
    "drive",
    "load_course",
    "load_parameters",
    "make_course",
    "read_course",
]


def __getattr__(name: str) -> Any:
    """Load the interface when it is used: importing the package alone costs nothing."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(importlib.import_module(f"{__name__}.api"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """Return the names of the interface too."""
    return sorted({*globals(), *__all__})
