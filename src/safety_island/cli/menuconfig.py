# SPDX-License-Identifier: Apache-2.0
"""``island menuconfig``: the familiar menu on the configuration of a target."""

from __future__ import annotations

import argparse
import sys

from safety_island.cli.configuration import add_target
from safety_island.cli.parser import UsageError, teach
from safety_island.targets.package.built import refuse_in_built


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    teach(
        parser,
        """
Change the configuration of a target in a menu: arrow keys and Enter move, space toggles, '?'
explains a symbol, '/' searches, 'S' saves, 'Q' leaves. What you save is kept as a fragment in
build/TARGET/menuconfig.conf, and every later run and build of the target takes it.
""",
        ("island menuconfig -t posix", "choose for a plain Linux machine"),
        ("island config diff -t posix", "afterwards: see what was chosen"),
    )
    add_target(parser)


def execute(arguments: argparse.Namespace) -> int:
    """Open the menu."""
    refuse_in_built("island menuconfig")
    from safety_island.targets.kconfig.menu import edit
    from safety_island.targets.kconfig.places import Places
    from safety_island.targets.kconfig.targets import find_target

    target = find_target(arguments.target)
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        raise UsageError(
            "menuconfig needs a terminal; without one use --conf or -D, or write "
            f"{Places().saved(target)}"
        )
    lines = edit(target.name)
    if lines is None:
        print("nothing was saved")
    elif lines:
        print(f"{Places().saved(target)} now holds:")
        print("\n".join(lines))
    else:
        print("all symbols are as shipped")
    return 0
