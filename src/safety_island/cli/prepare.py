# SPDX-License-Identifier: Apache-2.0
"""``island prepare``: compile the control kernels ahead of the first run."""

from __future__ import annotations

import argparse

from safety_island.cli.parser import teach
from safety_island.cli.progress import prepare_kernels


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    teach(
        parser,
        """
Compile the control kernels and keep the machine code on disk, so that later starts are quick.
Every command that needs them does this by itself; say it ahead in an image or before a test.
The folder is $SAFETY_ISLAND_CACHE, else $XDG_CACHE_HOME/safety-island or ~/.cache/safety-island.
""",
        ("island prepare", "compile what is not compiled yet"),
    )
    parser.add_argument("--all", action="store_true", help="also what only OSQP and the tests need")


def execute(arguments: argparse.Namespace) -> int:
    """Compile, or find that it was done."""
    prepare_kernels(arguments.all)
    return 0
