# SPDX-License-Identifier: Apache-2.0
"""Names of the functions inside an object file."""

from __future__ import annotations

import re
from typing import Any

_LENGTH = re.compile(r"\d+")


def shorten(module: Any) -> None:
    """Give inner functions short names that do not depend on the order of compilation."""
    taken: dict[str, int] = {}
    for function in module.functions:
        if function.is_declaration or not function.name.startswith("_ZN"):
            continue
        short = ".".join(_parts(function.name)[-2:])
        taken[short] = taken.get(short, 0) + 1
        function.name = short if taken[short] == 1 else f"{short}.{taken[short]}"


def _parts(mangled: str) -> list[str]:
    """The names in ``_ZN6module8function...``."""
    found, rest = [], mangled.removeprefix("_ZN")
    while match := _LENGTH.match(rest):
        end = match.end() + int(match[0])
        found.append(rest[match.end() : end])
        rest = rest[end:]
    return found
