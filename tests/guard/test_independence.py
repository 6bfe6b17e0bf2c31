# SPDX-License-Identifier: Apache-2.0
"""The rules of the guard know of no compiler and of no other code."""

from __future__ import annotations

import ast
from pathlib import Path
from types import FunctionType
from typing import Any

from safety_island.guard import guard

rules: Any = guard  # without types
TREE = ast.parse(Path(guard.__file__).read_text("utf-8"))


def test_the_rules_import_mathematics_and_the_names_of_their_limits_alone() -> None:
    found = [node for node in ast.walk(TREE) if isinstance(node, ast.Import | ast.ImportFrom)]
    assert [ast.unparse(node) for node in found] == [
        "import math",
        "from safety_island.guard.limit import Limit, Verdict",
        "from safety_island.kernel.math.inverse import atan",
        "from safety_island.kernel.math.trigonometric import tan",
    ]


def test_no_function_of_the_rules_has_a_decorator() -> None:
    functions = [node for node in ast.walk(TREE) if isinstance(node, ast.FunctionDef)]
    assert len(functions) > 10
    assert not any(node.decorator_list for node in functions)
    assert not any(isinstance(node, ast.ClassDef) for node in ast.walk(TREE))


def test_what_is_compiled_from_outside_stays_plain_python() -> None:
    functions = [item for item in vars(rules).values() if isinstance(item, FunctionType)]
    assert {rules.guard_command, rules.hold} < set(functions)
    assert rules.hold(3.0, 3.0, 0, 0.0, 2.0, 1) == (2.0, 1)


def test_the_numbers_of_verdicts_and_limits_are_plain_ones() -> None:
    """A compiler knows no enumeration of flags."""
    numbers = [value for value in vars(rules).values() if isinstance(value, int)]
    assert len(numbers) >= 15
    assert {type(value) for value in numbers} == {int}
