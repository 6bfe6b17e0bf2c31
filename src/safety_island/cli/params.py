# SPDX-License-Identifier: Apache-2.0
"""``island params``: show a parameter set with its units, ranges and origins, or check files."""

from __future__ import annotations

import argparse
import dataclasses
import json
from collections.abc import Iterable, Sequence
from itertools import groupby

from safety_island.cli.options import add_json, add_params
from safety_island.cli.parameters import read_parameters
from safety_island.cli.parser import teach
from safety_island.params import Loaded, Row, describe, notes


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare ``show`` and ``check``."""
    teach(
        parser,
        """
Parameters come from a shipped set (default, firmware, autoware-0.40) and from Autoware's own
parameter files laid over it. 'show' prints every value with its unit, the allowed range and the
file and line that it comes from; 'check' tells every mistake of the files, with file and line.
""",
        ("island params show", "the default set"),
        ("island params show --params firmware --against default", "where two sets differ"),
        ("island params show --params my/mpc.param.yaml --doc", "a file over the default set"),
        ("island params check my/mpc.param.yaml my/pid.param.yaml", "exit code 2 on a mistake"),
    )
    actions = parser.add_subparsers(dest="action", metavar="show|check", required=True)
    show = actions.add_parser("show", help="print every parameter")
    add_params(show)
    show.add_argument(
        "--against", metavar="SET", help="only where it differs from this set or file"
    )
    show.add_argument("--doc", action="store_true", help="explain each parameter")
    add_json(show, "the parameters")
    check = actions.add_parser("check", help="tell what is wrong with parameter files")
    check.add_argument("params", nargs="+", metavar="FILE", help="a set's name may come first")


def execute(arguments: argparse.Namespace) -> int:
    """Show or check."""
    loaded = read_parameters(arguments.params)
    if arguments.action == "check":
        _report_check(loaded, arguments.params)
        return 0
    rows = describe(loaded)
    if arguments.against is not None:
        other = {row.key: row for row in describe(read_parameters([arguments.against]))}
        rows = [row for row in rows if row.value != other[row.key].value]
        rows = [dataclasses.replace(r, value=f"{r.value} (not {other[r.key].value})") for r in rows]
    if arguments.json:
        print(json.dumps([dataclasses.asdict(row) for row in rows], indent=2))
    else:
        print(f"{loaded.release}\n")
        print("\n".join(lines(rows, arguments.doc)))
    return 0


def lines(rows: Iterable[Row], doc: bool) -> Iterable[str]:
    """Yield the rows as aligned text, a paragraph for each group."""
    for group, members in groupby(rows, key=lambda row: row.group):
        table = list(members)
        columns = [(row.key, f"{row.value} {row.unit}".strip(), row.allowed) for row in table]
        widths = [max(len(cells[i]) for cells in columns) for i in range(3)]
        yield f"{group}:"
        for row, cells in zip(table, columns, strict=True):
            text = "  ".join(cell.ljust(width) for cell, width in zip(cells, widths, strict=True))
            yield f"  {text}  {row.origin}".rstrip()
            if doc:
                yield f"      {row.doc}"
        yield ""


def _report_check(loaded: Loaded, words: Sequence[str]) -> None:
    print(f"note: {loaded.release}")
    for line in (*loaded.translated, *loaded.ignored):
        print(f"note: {line}")
    for note in notes(loaded.parameters):
        print(f"note: {note}")
    print(f"{', '.join(words)}: no mistake found")
