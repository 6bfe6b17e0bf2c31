# SPDX-License-Identifier: Apache-2.0
"""Writes docs/json.md from its tables: ``python -m safety_island.cli.json_page``."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from safety_island.cli.exit_codes import EXIT_CODES
from safety_island.cli.json_keys import COMMANDS, Event, Key, Lines

PAGE = "docs/json.md"

INTRODUCTION = """\
# For programs: exit codes and JSON lines

Generated from `src/safety_island/cli/json_keys.py` and `exit_codes.py`. To renew this page:
`python -m safety_island.cli.json_page`.

## Exit codes

They are the same for every command.
"""

LINES = """\
## JSON lines

`island run`, `main-compute`, `bridge`, `status` and `monitor` print one JSON object a line on
standard output with `--json`; what is for a person goes to standard error. Each line has `event`.
The first line that is written has `version` as well, the version of the island. A key has one type
and one meaning within a command. A number that has no finite value is null. Numbers are in m, rad,
s and made of these unless the key says otherwise. Keys may be added in a later version; take what
you know.

A line is dropped rather than waited for when its reader is too slow, except in virtual time.
"""

STATUS = """\
## `island status --json`

Each line is one status of the island, event `status`, with the fields of
`safety_island_msgs/msg/Status`: enumerations by name, times in s with names that end in `_s`,
null for what has no value, and `held_by` as above. The comments in that `.msg` file and
[status](status.md) explain each.

## Other commands

`island demo`, `replay`, `bench`, `params show`, `config` and `can monitor` of a log print one JSON
document at their end. `island can monitor` of a live bus prints one each second.
"""


def render() -> str:
    """Return the page."""
    codes = "\n".join(f"| {code} | {meaning} |" for code, meaning in EXIT_CODES.items())
    sections = "\n".join(_section(name, lines) for name, lines in COMMANDS.items())
    return (
        f"{INTRODUCTION}\n| code | meaning |\n| --- | --- |\n{codes}\n\n"
        f"{LINES}\n{sections}\n{STATUS}"
    )


def _section(command: str, lines: Lines) -> str:
    events = "\n".join(_event(name, event) for name, event in lines.events.items())
    keys = "\n".join(_key(name, lines.keys[name]) for name in sorted(lines.keys))
    return (
        f"## `{command}`\n\n| event | when | keys |\n| --- | --- | --- |\n{events}\n\n"
        f"| key | type | meaning |\n| --- | --- | --- |\n{keys}\n"
    )


def _event(name: str, event: Event) -> str:
    keys = ", ".join(f"`{key}`" for key in event.keys)
    more = ", ".join(f"`{key}`" for key in event.sometimes)
    return f"| `{name}` | {event.when} | {keys}{f'; where there is one: {more}' if more else ''} |"


def _key(name: str, key: Key) -> str:
    return f"| `{name}` | {key.kind}{' or null' if key.may_be_null else ''} | {key.meaning} |"


def main(arguments: Sequence[str]) -> None:
    """Write the page to the path given, or to where it belongs below the working directory."""
    path = Path(arguments[0] if arguments else PAGE)
    path.write_text(render(), "utf-8")
    print(f"wrote {path}")


if __name__ == "__main__":
    main(sys.argv[1:])
