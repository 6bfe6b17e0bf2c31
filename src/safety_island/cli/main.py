# SPDX-License-Identifier: Apache-2.0
"""The entry point of ``island``: find the command, run it, turn every error into one line."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Sequence

from safety_island import __version__
from safety_island.cli import streams
from safety_island.cli.exit_codes import EXIT_CODES
from safety_island.cli.foreign import printable
from safety_island.cli.memory_limit import check_memory_limit
from safety_island.cli.parser import OPTIONS_LIKE, Parser, UsageError
from safety_island.cli.table import COMMANDS, Command, find, load
from safety_island.cli.tell import tell
from safety_island.errors import IslandError
from safety_island.words import did_you_mean

DEBUG = "SAFETY_ISLAND_DEBUG"
"""Environment variable that lets an unforeseen exception show where it comes from."""

MOST_LINES = 200
"""Of mistakes in a file that are shown: more than a good file has lines to go wrong in."""

PURPOSE = """\
Autoware's trajectory follower as a safety island: it reads five ROS 2 topics on a DDS domain of
its own and answers with one control command every period."""


def overview() -> str:
    """Return the help of ``island`` itself."""
    width = max(len(command.name) for command in COMMANDS)
    rows = [f"  {command.name:<{width}}  {command.summary}" for command in COMMANDS]
    return "\n".join(
        [
            "usage: island COMMAND [ARGUMENTS]",
            "",
            PURPOSE,
            "",
            "commands:",
            *rows,
            "",
            "exit codes:",
            *(f"  {code:>3}  {meaning}" for code, meaning in EXIT_CODES.items()),
            "",
            "'island COMMAND --help' explains a command and shows examples.",
            "'island --version' prints the version. Start with: island demo",
        ]
    )


def choose(name: str) -> Command:
    """Return the command of that name; an unknown one is answered with the nearest."""
    command = find(name)
    if command is None:
        kind = "option" if name.startswith("-") else "command"
        hint = did_you_mean(name, [command.name for command in COMMANDS], OPTIONS_LIKE)
        raise UsageError(f"unknown {kind} '{name}'{hint} (see 'island --help')")
    return command


def dispatch(arguments: list[str]) -> int:
    """Run the command that the arguments name; return its exit code."""
    if not arguments or arguments[0] in ("-h", "--help", "help"):
        print(overview())
        return 0
    if arguments[0] in ("-V", "--version"):
        print(f"island {__version__}")
        return 0
    command = choose(arguments[0])
    module = load(command)
    parser = Parser(prog=f"island {command.name}")
    module.configure(parser)
    parsed = parser.parse(arguments[1:])
    check_memory_limit(command.name, command.need)
    return module.execute(parsed)


def main(argv: Sequence[str] | None = None) -> int:
    """Run ``island``; return the exit code (a user's error is one line on standard error)."""
    streams.open_missing()
    try:
        code = dispatch(list(sys.argv[1:] if argv is None else argv))
        sys.stdout.flush()
        return code
    except IslandError as error:
        return _complain(str(error), error.exit_code)
    except KeyboardInterrupt:
        return 128 + signal.SIGINT
    except BrokenPipeError:  # nobody reads on
        streams.give_up(sys.stdout)
        return 128 + signal.SIGPIPE
    except Exception as error:
        if isinstance(error, OSError) and streams.is_full(error):
            streams.give_up(sys.stdout)
            return _complain(f"cannot write: {error.strerror}; make room and try again", 1)
        if os.environ.get(DEBUG):
            raise
        fault = f"{type(error).__name__}: {error}"
        return _complain(f"a fault of the island itself: {fault} ({DEBUG}=1 shows where)", 70)


def _complain(message: str, code: int) -> int:
    lines = message.splitlines()
    if len(lines) > MOST_LINES:
        lines[MOST_LINES:] = [f"and {len(lines) - MOST_LINES} more of this kind"]
    for line in lines:
        tell(f"island: error: {printable(line)}")
    return code
