# SPDX-License-Identifier: Apache-2.0
"""What the code says of itself, for the generated page: members of enumerations, fields."""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Iterator
from enum import Enum
from importlib.resources import files
from itertools import pairwise
from typing import NamedTuple

_COMMENT = re.compile(r"(?:\[(?P<unit>[^]]*)\] )?(?P<meaning>.*)")


class MessageField(NamedTuple):
    """One field of a ``.msg`` file; ``unit`` is empty where it has none."""

    name: str
    type: str
    unit: str
    meaning: str


def member_docs(enum: type[Enum]) -> dict[str, str]:
    """Return the docstring below each member of an enumeration, by the member's name."""
    (definition,) = ast.parse(inspect.getsource(enum)).body
    assert isinstance(definition, ast.ClassDef)
    found: dict[str, str] = {}
    for member, doc in pairwise(definition.body):
        if isinstance(member, ast.Assign) and isinstance(doc, ast.Expr):
            (name,) = member.targets
            found[ast.unparse(name)] = inspect.cleandoc(ast.literal_eval(doc.value))
    return found


def message_fields(type_name: str) -> Iterator[MessageField]:
    """Yield the fields of one of our own messages, with the comment above each."""
    package, kind, short = type_name.split("/")
    path = files("safety_island.messages") / "msg" / package / kind / f"{short}.msg"
    comment = ""
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.startswith("#"):
            comment = line.removeprefix("#").strip()
        elif line and "=" not in line:
            field_type, name = line.split()
            found = _COMMENT.fullmatch(comment)
            assert found is not None
            yield MessageField(name, field_type, found["unit"] or "", found["meaning"])
