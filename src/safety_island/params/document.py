# SPDX-License-Identifier: Apache-2.0
"""Writes docs/parameters.md from the dataclasses, the rules and the shipped sets.

``python -m safety_island.params.document [FILE]``, docs/parameters.md when none is named.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from safety_island.params.consistency import RULES
from safety_island.params.loader import load_set
from safety_island.params.no_effect import NO_EFFECT, PREFIXES
from safety_island.params.reasons import REASONS
from safety_island.params.scalars import shown
from safety_island.params.schema import GROUPS, KNOWN, Known, values_of
from safety_island.params.sets import FILES, SETS

_FILES_OF_GROUP = {
    "vehicle": FILES[:1],
    "node": FILES[1:3],
    "lateral": FILES[3:4],
    "longitudinal": FILES[4:5],
    "gate": FILES[5:6],
    "life_cycle": FILES[6:7],
    "guard": FILES[7:8],
}
_KINDS = {"list": "list of float", "str": "text", "bool": "switch"}


def render() -> str:
    """Return the whole page."""
    values = [values_of(load_set(name)) for name in SETS]
    head = Path(__file__).with_name("document.md").read_text("utf-8")
    groups = (_group(group, values) for group in GROUPS)
    return "\n".join([head, *groups, _differences(values), _rules(), _ignored()])


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines) + "\n"


def _group(group: str, values: list[dict[str, Any]]) -> str:
    files = ", ".join(f"`{file}`" for file in _FILES_OF_GROUP[group])
    head = ("key", "type", "unit", "allowed", *SETS, "meaning")
    known = [item for item in KNOWN.values() if item.group == group]
    title = GROUPS[group].__doc__.split(" (")[0]
    return f"## {title}\n\nIn the shipped sets: {files}.\n\n" + _table(
        head, (_row(item, values) for item in known)
    )


def _row(known: Known, values: list[dict[str, Any]]) -> list[str]:
    return [
        f"`{known.key}`",
        _KINDS.get(known.kind, known.kind),
        known.unit,
        known.range_text,
        *(shown(of_set[known.key]) for of_set in values),
        known.doc,
    ]


def _differences(values: list[dict[str, Any]]) -> str:
    head = ("key", *SETS, "why in ours")
    rows = [
        [f"`{key}`", *(shown(of_set[key]) for of_set in values), REASONS[key]]
        for key in KNOWN
        if len({of_set[key] for of_set in values}) > 1
    ]
    return "## Where the sets differ\n\n" + _table(head, rows)


def _rules() -> str:
    return "## What must fit together\n\n" + "\n".join(f"- {rule.doc}." for rule in RULES) + "\n"


def _ignored() -> str:
    known = {**NO_EFFECT, **{f"{prefix}*": reason for prefix, reason in PREFIXES.items()}}
    rows = (
        [f"`{key}`", "any" if item.only is None else shown(item.only), item.reason]
        for key, item in known.items()
    )
    return (
        "## Keys without effect\n\nThey stand in Autoware's real files; they are accepted, and told"
        " at the start.\n\n" + _table(("key", "allowed", "why"), rows)
    )


def main(arguments: Sequence[str]) -> None:
    """Write the page to the file that is named, or to docs/parameters.md."""
    path = Path(arguments[0]) if arguments else Path("docs/parameters.md")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(render(), "utf-8")
    print(f"wrote {path}")


if __name__ == "__main__":
    main(sys.argv[1:])
