# SPDX-License-Identifier: Apache-2.0
"""``island can dbc`` and ``island can tables``: what derives from the table of frames."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from safety_island.errors import ConfigurationError
from safety_island.text_file import UnreadableError, read_text


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of ``dbc``."""
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--output", metavar="FILE", help="write to a file instead of the terminal")
    what.add_argument("--check", metavar="FILE", help="compare a DBC file with the encoder")
    parser.set_defaults(run=execute)


def configure_tables(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of ``tables``."""
    parser.add_argument("--update", metavar="FILE", help="renew the marked tables of a page")
    parser.set_defaults(run=execute_tables)


def execute(arguments: argparse.Namespace) -> int:
    """Write the DBC file, or check one: every difference is a line, and the exit code 1."""
    from safety_island.can.dbc import dbc_text

    if arguments.check is not None:
        return _check(arguments.check)
    if arguments.output is not None:
        _write(arguments.output, dbc_text())
    else:
        sys.stdout.write(dbc_text())
    return 0


def _check(name: str) -> int:
    from safety_island.can.dbc_check import check_dbc

    differences = check_dbc(_read(name))
    for difference in differences:
        print(f"{name}: {difference}")
    if not differences:
        print(f"{name}: agrees with the encoder")
    return 1 if differences else 0


def execute_tables(arguments: argparse.Namespace) -> int:
    """Print the tables, or renew them in a page."""
    from safety_island.can.tables import TABLES, refresh

    if arguments.update is not None:
        _write(arguments.update, refresh(_read(arguments.update)))
    else:
        print("\n".join(table() for table in TABLES.values()), end="")
    return 0


def _read(name: str) -> str:
    try:
        return read_text(Path(name))
    except UnreadableError as why:
        raise ConfigurationError(f"{name}: cannot be read: {why}") from None


def _write(name: str, text: str) -> None:
    try:
        Path(name).write_text(text, encoding="utf-8")
    except OSError as error:
        raise ConfigurationError(f"{name}: cannot be written: {error.strerror}") from error
