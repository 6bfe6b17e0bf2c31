"""The commands of ``island``: a name, where it lives, one line of help.

A command's module is imported when it is chosen, so that ``island --help`` needs none of them. It
has ``configure(parser)``, which declares the arguments, and ``execute(arguments)``, which returns
the exit code.
"""

from __future__ import annotations

import argparse
import importlib
from typing import NamedTuple, Protocol, cast


class Command(NamedTuple):
    """One row: the module is named without ``safety_island.cli.``."""

    name: str
    module: str
    summary: str


COMMANDS = (
    Command("demo", "demo", "Watch the island drive a vehicle: three processes, one live view."),
    Command("run", "run", "Run the safety island."),
    Command("status", "status", "Show what the island does, and why nothing is published."),
    Command("arm", "arm", "Ask a silent island to send commands again."),
    Command("bridge", "bridge", "Forward topics between two DDS domains."),
    Command("main-compute", "main_compute", "Stand in for Autoware: a planner and a vehicle."),
    Command("replay", "replay", "Feed recorded runs through the controllers and compare."),
    Command("bench", "bench", "Measure the tick, or the way from odometry to command."),
    Command("params", "params", "Show or check controller parameters."),
    Command("can", "can", "Watch, send and describe the CAN command frames."),
    Command("env", "env", "Print what other DDS programs need to meet the island."),
    Command("config", "config", "Show the configuration of a target."),
    Command("menuconfig", "menuconfig", "Choose the configuration of a target in a menu."),
    Command("build", "build", "Build a target: kernels, C headers, one self-contained program."),
    Command(
        "prepare", "prepare", "Compile the control kernels now, so that later starts are quick."
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
