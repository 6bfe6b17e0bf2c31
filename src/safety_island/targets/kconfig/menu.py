# SPDX-License-Identifier: Apache-2.0
"""The menu of ``island menuconfig``, and the fragment that keeps what was chosen in it.

As in Zephyr the menu works on ``build/<target>/.config``. What differs there from the shipped
fragments is kept as one more fragment, so that a later edit of those is not lost.
"""

from __future__ import annotations

import importlib
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from safety_island.targets.kconfig.merge import merge, read
from safety_island.targets.kconfig.places import Places
from safety_island.targets.kconfig.resolve import resolve
from safety_island.targets.kconfig.symbols import has_prompt, load_kconfig
from safety_island.targets.kconfig.targets import Target, find_target

Menu = Callable[[Any], None]


def edit(target: str, places: Places | None = None, menu: Menu | None = None) -> list[str] | None:
    """Open the menu on the configuration of a target.

    Returns the lines of the fragment that is kept from now on (empty: all as shipped), None when
    nothing was saved. ``menu`` is given the parsed Kconfig; by default it is kconfiglib's.
    """
    row = find_target(target)
    where = places if places is not None else Places()
    path = where.dotconfig(row)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(resolve(target, places=where).dotconfig(), encoding="utf-8")
    before = path.read_bytes()
    with _environment("KCONFIG_CONFIG", str(path)):
        (menu or _terminal_menu())(load_kconfig(where.kconfig))
    if path.read_bytes() == before:
        return None
    return _keep(row, where, path)


def _terminal_menu() -> Menu:
    menu: Menu = importlib.import_module("menuconfig").menuconfig
    return menu


@contextmanager
def _environment(name: str, value: str) -> Iterator[None]:
    before = os.environ.get(name)
    os.environ[name] = value
    try:
        yield
    finally:
        if before is None:
            del os.environ[name]
        else:
            os.environ[name] = before


def _keep(target: Target, places: Places, dotconfig: Path) -> list[str]:
    """Write what the saved configuration changes of the shipped one as a fragment."""
    saved = places.saved(target)
    saved.unlink(missing_ok=True)
    shipped, chosen = load_kconfig(places.kconfig), load_kconfig(places.kconfig)
    merge(shipped, read(places.fragments_of(target)))
    chosen.load_config(str(dotconfig))
    lines = [
        chosen.syms[symbol.name].config_string.strip()
        for symbol in shipped.unique_defined_syms
        if has_prompt(symbol) and chosen.syms[symbol.name].str_value != symbol.str_value
    ]
    lines = [line for line in lines if line]
    if lines:
        head = f"# Chosen in 'island menuconfig -t {target.name}'; to undo it delete this file.\n"
        saved.write_text(head + "\n".join(lines) + "\n", encoding="utf-8")
    dotconfig.write_text(resolve(target.name, places=places).dotconfig(), encoding="utf-8")
    return lines
