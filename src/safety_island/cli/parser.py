# SPDX-License-Identifier: Apache-2.0
"""An argument parser whose errors are one line and whose help teaches."""

from __future__ import annotations

import argparse
from typing import Any, NoReturn

from safety_island.errors import IslandError
from safety_island.words import did_you_mean

OPTIONS_LIKE = 0.5
"""How alike a word on the command line must be to what there is: they are short."""


class UsageError(IslandError):
    """The command line cannot be understood."""

    exit_code = 2


class Parser(argparse.ArgumentParser):
    """Raises UsageError instead of printing its usage and leaving."""

    def __init__(self, **options: Any) -> None:
        options.setdefault("formatter_class", argparse.RawDescriptionHelpFormatter)
        super().__init__(allow_abbrev=False, **options)

    def error(self, message: str) -> NoReturn:
        """Raise UsageError; argparse calls this."""
        raise UsageError(f"{message} (see '{self.prog} --help')")

    def parse(self, arguments: list[str]) -> argparse.Namespace:
        """Parse all arguments; an unknown option is answered with the nearest known one."""
        known, unknown = self.parse_known_args(arguments)
        if unknown:
            hint = did_you_mean(unknown[0].split("=")[0], self._options(), OPTIONS_LIKE)
            self.error(f"unknown argument '{unknown[0]}'{hint}")
        return known

    def _options(self) -> list[str]:
        below = (action.choices for action in self._actions if action.nargs == argparse.PARSER)
        parsers = [self, *(parser for choices in below for parser in dict(choices or {}).values())]
        return [option for parser in parsers for option in parser._option_string_actions]


def teach(parser: argparse.ArgumentParser, purpose: str, *examples: tuple[str, str]) -> None:
    """Give a command's help its purpose and its examples, each with what it does."""
    parser.description = purpose.strip()
    lines = [f"  {command}\n      {meaning}" for command, meaning in examples]
    parser.epilog = "examples:\n" + "\n".join(lines)
