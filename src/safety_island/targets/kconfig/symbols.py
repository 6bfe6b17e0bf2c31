# SPDX-License-Identifier: Apache-2.0
"""The symbols of ``config/Kconfig``: which assignments they take, and what they say of themselves.

Kconfiglib parses and evaluates; here its answers become sentences for a user.
"""

from __future__ import annotations

import gc
import re
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import kconfiglib

from safety_island.errors import ConfigurationError
from safety_island.targets.kconfig import zephyr as kconfig_zephyr
from safety_island.targets.kconfig.fragment import PREFIX, Assignment, quote, shown, unquote
from safety_island.words import did_you_mean

Value = bool | int | str

_WHOLE = re.compile(r"-?[0-9]{1,18}")


def load_kconfig(path: Path) -> Any:
    """Parse the Kconfig file. Raises ConfigurationError when it is missing or has a mistake."""
    try:
        kconfig = kconfiglib.Kconfig(str(path), warn_to_stderr=False)
    except (kconfiglib.KconfigError, OSError) as error:
        text = " ".join(str(error).split())
        kconfig = None
    if kconfig is None:
        _close_files()
        raise ConfigurationError(f"{shown(path)}: cannot be read as Kconfig: {text}")
    if kconfig.warnings:
        raise ConfigurationError("\n".join(" ".join(text.split()) for text in kconfig.warnings))
    return kconfig


def _close_files() -> None:
    """Close what kconfiglib leaves open at a mistake; it sits in a cycle of references."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResourceWarning)
        gc.collect()


def value_of(symbol: Any) -> Value:
    """Return the present value: False, 0 or an empty text for a symbol whose needs are not met."""
    if symbol.orig_type == kconfiglib.BOOL:
        return bool(symbol.str_value == "y")
    if symbol.orig_type == kconfiglib.INT:
        return int(symbol.str_value or "0")
    return str(symbol.str_value)


def written(assignment: Assignment, symbol: Any) -> Value:
    """Return the value that an assignment of the right form stands for."""
    if symbol.orig_type == kconfiglib.BOOL:
        return assignment.value == "y"
    if symbol.orig_type == kconfiglib.INT:
        return int(assignment.value)
    return str(unquote(assignment.value))


def has_prompt(symbol: Any) -> bool:
    """Whether a user may set the symbol; the others follow from these."""
    return any(node.prompt for node in symbol.nodes)


def needs(symbol: Any) -> str:
    """Return the condition that hides the symbol at present, nothing when it is in force."""
    if kconfiglib.expr_value(symbol.direct_dep):
        return ""
    return str(kconfiglib.expr_str(symbol.direct_dep))


def active_range(symbol: Any) -> tuple[int, int] | None:
    """Return the lowest and highest value that an int symbol may have, None without a range."""
    for low, high, condition in symbol.ranges:
        if kconfiglib.expr_value(condition):
            return int(low.str_value), int(high.str_value)
    return None


def apply(assignment: Assignment, symbol: Any) -> None:
    """Give the symbol its value, as kconfiglib does when it reads a ``.config``."""
    value = written(assignment, symbol)
    if symbol.orig_type == kconfiglib.BOOL:
        text = "y" if value else "n"
        if symbol.choice is not None and value:
            symbol.choice.set_value(text)
        symbol.set_value(text)
    else:
        symbol.set_value(str(value))


def with_quotes(kconfig: Any, assignment: Assignment) -> Assignment:
    """Return an assignment of the command line with the quotes that its text may lack."""
    symbol = kconfig.syms.get(assignment.symbol)
    is_text = symbol is not None and symbol.orig_type == kconfiglib.STRING
    if is_text and assignment.is_override and unquote(assignment.value) is None:
        return assignment._replace(value=quote(assignment.value))
    return assignment


def refusal(kconfig: Any, assignment: Assignment) -> str | None:
    """Return why no configuration could take this assignment, None when one could."""
    symbol = kconfig.syms.get(assignment.symbol)
    if symbol is None or not symbol.nodes:
        return _unknown(kconfig, assignment.symbol)
    if not has_prompt(symbol):
        causes = ", ".join(dict.fromkeys(_causes(kconfig, symbol)))
        return f"{PREFIX}{symbol.name} cannot be set: it follows from {causes}"
    expected = _expected_form(symbol, assignment.value)
    return f"{assignment}: expected {expected}" if expected else None


def is_zephyrs(kconfig: Any, assignment: Assignment) -> bool:
    """Whether a line of a file sets a symbol that only the firmware has."""
    symbol = kconfig.syms.get(assignment.symbol)
    if assignment.is_override or (symbol is not None and symbol.nodes):
        return False
    names = [item.name for item in kconfig.unique_defined_syms]
    return kconfig_zephyr.is_zephyrs(assignment.symbol, [*names, *kconfig.named_choices])


def not_taken(assignment: Assignment, symbol: Any) -> str | None:
    """Return why a symbol has not the value that was assigned, None when it has."""
    value = written(assignment, symbol)
    limits = active_range(symbol)
    if limits is not None and isinstance(value, int) and not limits[0] <= value <= limits[1]:
        return f"{assignment}: expected a whole number from {limits[0]} to {limits[1]}"
    if value_of(symbol) == value:
        return None
    if needs(symbol):
        return f"{assignment}: this needs {needs(symbol)}, which does not hold"
    members = ", ".join(PREFIX + member.name for member in symbol.choice.syms)
    return f"{assignment}: exactly one of {members} is y"


def _unknown(kconfig: Any, name: str) -> str:
    choice = kconfig.named_choices.get(name)
    if choice is not None:
        members = ", ".join(f"{PREFIX}{symbol.name}=y" for symbol in choice.syms)
        return f"{PREFIX}{name} is a choice: set one of {members}"
    known = [symbol.name for symbol in kconfig.unique_defined_syms if has_prompt(symbol)]
    hint = (
        did_you_mean(PREFIX + name, [PREFIX + other for other in known])
        or "; see 'island config show'"
    )
    return f"unknown symbol {PREFIX}{name}{hint}"


def _causes(kconfig: Any, symbol: Any) -> Iterator[str]:
    """Symbols that decide about one without a prompt."""
    for other in kconfig.unique_defined_syms:
        if any(selected is symbol for selected, _ in other.selects):
            yield PREFIX + other.name
    for _, condition in symbol.defaults:
        for item in kconfiglib.expr_items(condition):
            if not item.is_constant:
                yield PREFIX + item.name


def _expected_form(symbol: Any, value: str) -> str | None:
    """What the type of the symbol demands, None when the value has that form."""
    if symbol.orig_type == kconfiglib.BOOL:
        return None if value in ("y", "n") else "y or n"
    if symbol.orig_type == kconfiglib.INT:
        return None if _WHOLE.fullmatch(value) else "a whole number"
    return None if unquote(value) is not None else 'a text in quotes, for example "eth0"'
