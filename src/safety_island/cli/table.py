# SPDX-License-Identifier: Apache-2.0
"""The commands of ``island``: a name, where it lives, one line of help.

A command's module is imported when it is chosen, so that ``island --help`` needs none of them. It
has ``configure(parser)``, which declares the arguments, and ``execute(arguments)``, which returns
the exit code.
"""

from __future__ import annotations

import argparse
import importlib
from typing import NamedTuple, Protocol, cast

from safety_island.cli.memory_limit import Need


class Command(NamedTuple):
    """One row: the module is named without ``safety_island.cli.``."""

    name: str
    module: str
    summary: str
    need: Need | None = None
    """The memory that it takes, where that is much."""


_TWO_DOMAINS, _ONE_DOMAIN = Need(1100, 200), Need(750, 160)
_ISLAND, _KERNELS = Need(1100, 300, kernels=True), Need(600, 300, kernels=True)

COMMANDS = (
    Command(
        "demo",
        "demo",
        "Watch the island drive a vehicle, in the terminal and in the browser.",
        _ISLAND,
    ),
    Command("run", "run", "Run the safety island.", _ISLAND),
    Command(
        "status", "status", "Show what the island does, and why nothing is published.", _ONE_DOMAIN
    ),
    Command(
        "monitor",
        "monitor",
        "Serve a live page of what the island does, for a browser.",
        _ONE_DOMAIN,
    ),
    Command("arm", "arm", "Ask a silent island to send commands again.", _ONE_DOMAIN),
    Command("bridge", "bridge", "Forward topics between two DDS domains.", _TWO_DOMAINS),
    Command(
        "main-compute",
        "main_compute",
        "Stand in for Autoware: a planner and a vehicle.",
        _ONE_DOMAIN,
    ),
    Command(
        "replay", "replay", "Feed recorded runs through the controllers and compare.", _KERNELS
    ),
    Command("bench", "bench", "Measure the tick, or the way from odometry to command.", _ISLAND),
    Command("params", "params", "Show or check controller parameters."),
    Command("can", "can", "Watch, send and describe the CAN command frames."),
    Command("env", "env", "Print what other DDS programs need to meet the island."),
    Command("config", "config", "Show the configuration of a target."),
    Command("menuconfig", "menuconfig", "Choose the configuration of a target in a menu."),
    Command(
        "build",
        "build",
        "Build a target: kernels, C headers, one self-contained program.",
        _KERNELS,
    ),
    Command(
        "prepare",
        "prepare",
        "Compile the control kernels now, so that later starts are quick.",
        _KERNELS,
    ),
)


class CommandModule(Protocol):
    """What the module of a command offers."""

    def configure(self, parser: argparse.ArgumentParser) -> None:
        """Declare the arguments."""

    def execute(self, arguments: argparse.Namespace) -> int:
        """Do it; return the exit code."""


def find(name: str) -> Command | None:
    """Return the row of a command, or None."""
    return next((command for command in COMMANDS if command.name == name), None)


def load(command: Command) -> CommandModule:
    """Import the module of a command."""
    module = importlib.import_module(f"safety_island.cli.{command.module}")
    return cast(CommandModule, module)
