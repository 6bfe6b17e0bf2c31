# SPDX-License-Identifier: Apache-2.0
"""Options that choose a target and change its configuration, and what they resolve to."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from safety_island.targets.kconfig.configuration import RunConfiguration
from safety_island.targets.kconfig.targets import NAMES
from safety_island.targets.package.built import built, refuse_in_built

if TYPE_CHECKING:
    from safety_island.targets.kconfig.resolve import Resolved


def add_target(parser: argparse.ArgumentParser, default: str | None = None) -> None:
    """Add ``-t``; without a default it must be given. A built island has its own."""
    own = built()
    default = default if own is None else own.target
    shown = f" (default: {default})" if default else ""
    parser.add_argument(
        "-t",
        "--target",
        required=default is None,
        default=default,
        metavar="TARGET",
        help=f"{', '.join(NAMES)}{shown}",
    )


def add_configuration(parser: argparse.ArgumentParser) -> None:
    """Add ``--conf`` and ``-D``."""
    parser.add_argument(
        "--conf",
        action="append",
        type=Path,
        default=[],
        metavar="FILE",
        help="a fragment of CONFIG_NAME=value lines over the target's own; may be repeated",
    )
    parser.add_argument(
        "-D",
        dest="define",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="set one symbol over all files, for example -D LOG_LEVEL=2; may be repeated",
    )


def resolved(arguments: argparse.Namespace) -> Resolved:
    """Return the configuration that the options choose; print which value replaced which."""
    from safety_island.targets.kconfig.resolve import resolve

    found = resolve(arguments.target, arguments.conf, arguments.define)
    for note in found.notes:
        print(f"note: {note}", file=sys.stderr)
    run_configuration(found)
    return found


def chosen(arguments: argparse.Namespace) -> RunConfiguration:
    """Return the configuration to run with: what the options choose, in a built island its own."""
    own = built()
    if own is None:
        return run_configuration(resolved(arguments))
    if arguments.target != own.target:
        refuse_in_built(f"-t {arguments.target}")
    for option, values in (("--conf", arguments.conf), ("-D", arguments.define)):
        if values:
            refuse_in_built(f"{option} {values[0]}")
    return own.configuration()


def run_configuration(found: Resolved) -> RunConfiguration:
    """Return a resolved configuration as the program uses it, its texts checked."""
    origins = found.origins()
    return RunConfiguration.from_symbols(found.target.name, found.values(), origins.__getitem__)
