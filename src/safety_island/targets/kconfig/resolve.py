# SPDX-License-Identifier: Apache-2.0
"""The configuration of a target: Kconfig defaults and fragments, merged as Zephyr does.

Order, the later one winning: the defaults of ``config/Kconfig``, ``prj_actuation.conf``,
``boards/<board>_actuation.conf`` (then ``boards/<board>@<revision>_actuation.conf`` where there is
one), what ``island menuconfig`` saved, the user's fragments, ``-D``.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from safety_island.targets.kconfig import symbols
from safety_island.targets.kconfig.fragment import PREFIX, Assignment, shown
from safety_island.targets.kconfig.merge import merge, read
from safety_island.targets.kconfig.places import Places
from safety_island.targets.kconfig.symbols import Value
from safety_island.targets.kconfig.targets import Target, find_target


@dataclass(frozen=True)
class Setting:
    """One symbol of a resolved configuration."""

    symbol: str
    value: Value
    default: Value
    origin: str
    """Where the value comes from: a file and line, an option, or a default."""
    line: str
    """As it stands in a ``.config``; empty when the symbol's needs are not met."""
    needs: str
    """The condition that is not met."""
    menu: str
    """The menus that lead to it."""

    @property
    def text(self) -> str:
        """The line, or why there is none."""
        if self.line:
            return self.line
        why = f"needs {self.needs}" if self.needs else "is not set"
        return f"# {PREFIX}{self.symbol} {why}"


@dataclass(frozen=True)
class Resolved:
    """The configuration of a target; ``notes`` tell which value replaced which."""

    target: Target
    settings: tuple[Setting, ...]
    notes: tuple[str, ...]

    def values(self) -> dict[str, Value]:
        """Return every symbol with its value."""
        return {setting.symbol: setting.value for setting in self.settings}

    def origins(self) -> dict[str, str]:
        """Return every symbol with where its value comes from."""
        return {setting.symbol: setting.origin for setting in self.settings}

    def dotconfig(self) -> str:
        """Return the text of a ``.config``: the same configuration gives the same bytes."""
        head = f"# Target {self.target.name}: the resolved configuration, written by island.\n"
        return head + "".join(f"{item.line}\n" for item in self.settings if item.line)


def resolve(
    target: str,
    fragments: Iterable[Path] = (),
    overrides: Iterable[str] = (),
    places: Places | None = None,
) -> Resolved:
    """Merge the configuration of a target.

    ``fragments`` are files of the user, ``overrides`` the ``NAME=value`` of ``-D``. Raises
    ConfigurationError with every mistake and its place.
    """
    row = find_target(target)
    where = places if places is not None else Places()
    sources = read(where.fragments_of(row), fragments, overrides)
    kconfig = symbols.load_kconfig(where.kconfig)
    defaults = {item.name: symbols.value_of(item) for item in kconfig.unique_defined_syms}
    in_force, notes = merge(kconfig, sources)
    settings = tuple(
        Setting(
            item.name,
            symbols.value_of(item),
            defaults[item.name],
            _origin(item, in_force),
            item.config_string.strip(),
            symbols.needs(item),
            _menu(item),
        )
        for item in kconfig.unique_defined_syms
    )
    return Resolved(row, settings, tuple(notes))


def _origin(symbol: Any, in_force: dict[str, Assignment]) -> str:
    chosen = in_force.get(symbol.choice.name) if symbol.choice is not None else None
    assignment = chosen or in_force.get(symbol.name)
    if assignment is not None:
        return assignment.place
    node = symbol.nodes[0]
    kind = "default" if symbols.has_prompt(symbol) else "follows"
    return f"{kind} ({shown(Path(node.filename))}:{node.linenr})"


def _menu(symbol: Any) -> str:
    """The prompts from the top down to the symbol, the main menu left out."""
    words = []
    node = symbol.nodes[0]
    while node.parent is not None:
        if node.prompt:
            words.append(str(node.prompt[0]))
        node = node.parent
    return " > ".join(reversed(words))
