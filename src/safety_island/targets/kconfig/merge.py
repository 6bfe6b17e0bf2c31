# SPDX-License-Identifier: Apache-2.0
"""Fragments one after the other into Kconfig, as Zephyr does: later wins, nothing is ignored."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

from safety_island.errors import ConfigurationError
from safety_island.targets.kconfig import symbols
from safety_island.targets.kconfig import zephyr as kconfig_zephyr
from safety_island.targets.kconfig.fragment import Assignment, read_fragment, read_override


def read(
    shipped: Iterable[Path], fragments: Iterable[Path] = (), overrides: Iterable[str] = ()
) -> list[list[Assignment]]:
    """Return the assignments of each file, then those of the command line.

    Raises ConfigurationError with every line that cannot be read.
    """
    sources: list[list[Assignment]] = []
    defined: list[Assignment] = []
    mistakes: list[str] = []
    words: list[Path | str] = [*shipped, *fragments, *overrides]
    for word in words:
        try:
            if isinstance(word, Path):
                sources.append(read_fragment(word))
            else:
                defined.append(read_override(word))
        except ConfigurationError as error:
            mistakes.append(str(error))
    _raise(mistakes)
    return [*sources, defined]


def merge(
    kconfig: Any, sources: Sequence[Sequence[Assignment]]
) -> tuple[dict[str, Assignment], list[str]]:
    """Give Kconfig all assignments; return those in force by symbol, and what replaced what.

    A member of a choice that was set to y stands under the name of the choice. Symbols of Zephyr
    are one note for each file. Raises
    ConfigurationError for an unknown symbol and for a value that Kconfig refuses: one that was not
    taken at the end of its source and is not at the end of all. What a later source turned off is
    told only.
    """
    zephyrs = [a for source in sources for a in source if symbols.is_zephyrs(kconfig, a)]
    sources = [[a for a in source if a not in zephyrs] for source in sources]
    every = [symbols.with_quotes(kconfig, item) for source in sources for item in source]
    _raise(f"{a.place}: {text}" for a in every if (text := symbols.refusal(kconfig, a)))
    in_force: dict[str, Assignment] = {}
    notes = kconfig_zephyr.notes(zephyrs)
    taken: set[Assignment] = set()
    left = iter(every)
    for source in sources:
        for item in islice(left, len(source)):
            notes += _apply(kconfig, item, in_force)
        taken |= {a for a in in_force.values() if not _not_taken(kconfig, a)}
    refused = [(a, text) for a in in_force.values() if (text := _not_taken(kconfig, a))]
    _raise(f"{a.place}: {text}" for a, text in refused if a not in taken)
    notes += [f"{a.place}: without effect: {text}" for a, text in refused]
    return in_force, notes


def _not_taken(kconfig: Any, item: Assignment) -> str | None:
    return symbols.not_taken(item, kconfig.syms[item.symbol])


def _apply(kconfig: Any, item: Assignment, in_force: dict[str, Assignment]) -> list[str]:
    """Apply one assignment; return what it replaces."""
    symbol = kconfig.syms[item.symbol]
    symbols.apply(item, symbol)
    name = symbol.name
    if symbol.choice is not None and item.value == "y":
        in_force.pop(name, None)
        name = symbol.choice.name
    before = in_force.get(name)
    in_force[name] = item
    if before is None or str(before) == str(item):
        return []
    return [f"{item.place}: {item} replaces {before} of {before.place}"]


def _raise(mistakes: Iterable[str]) -> None:
    found = list(mistakes)
    if found:
        raise ConfigurationError("\n".join(found))
