# SPDX-License-Identifier: Apache-2.0
"""Every small change of a Python source that a good test should notice."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import dataclass, field

from tests.mutation.changes import changes_of


@dataclass(frozen=True)
class Mutant:
    """A source with one change; ``source`` is the line that the change is in."""

    file: str
    line: int
    source: str
    change: str
    original: ast.AST = field(repr=False)
    index: int
    """Which node of the original is changed."""
    replacement: ast.AST = field(repr=False)

    @property
    def tree(self) -> ast.AST:
        """The changed source; made when asked for, since there are thousands."""
        copy = deepcopy(self.original)
        victim = list(_nodes(copy))[self.index]
        mutated: ast.AST = _Replace(victim, deepcopy(self.replacement)).visit(copy)
        return ast.fix_missing_locations(mutated)

    @property
    def place(self) -> str:
        """Where it is and what it does."""
        return f"{self.file}:{self.line}: {self.change}"


def mutants(file: str, text: str) -> Iterator[Mutant]:
    """Yield every mutant of a source text, in the order of its lines."""
    tree, lines = ast.parse(text), text.splitlines()
    returns, last = _functions(tree)
    found: list[Mutant] = []
    for index, node in enumerate(_nodes(tree)):
        line = getattr(node, "lineno", 0) or _line_within(node)
        seen = {ast.dump(node)}
        for change, new in changes_of(node, returns.get(id(node), ""), id(node) in last):
            if ast.dump(new) not in seen:
                seen.add(ast.dump(new))
                found.append(Mutant(file, line, lines[line - 1].strip(), change, tree, index, new))
    yield from sorted(found, key=lambda mutant: mutant.line)


def _line_within(node: ast.AST) -> int:
    return next((n.lineno for n in ast.walk(node) if hasattr(n, "lineno")), 1)


def _functions(tree: ast.AST) -> tuple[dict[int, str], set[int]]:
    """Of each return, by its id, what type its function says; and which of them are the last."""
    returns, last = dict[int, str](), set[int]()
    for function in ast.walk(tree):
        if isinstance(function, ast.FunctionDef | ast.AsyncFunctionDef):
            kind = ast.unparse(function.returns) if function.returns else ""
            returns |= {id(n): kind for n in ast.walk(function) if isinstance(n, ast.Return)}
            last.add(id(function.body[-1]))
    return returns, last


class _Replace(ast.NodeTransformer):
    def __init__(self, victim: ast.AST, replacement: ast.AST) -> None:
        self.victim, self.replacement = victim, replacement

    def visit(self, node: ast.AST) -> ast.AST:
        if node is self.victim:
            return ast.copy_location(self.replacement, node)
        found: ast.AST = self.generic_visit(node)
        return found


def _nodes(node: ast.AST) -> Iterator[ast.AST]:
    """Walk what runs: no annotation, no docstring, no alias of a type."""
    yield node
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns", "decorator_list", "type_comment"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST) and not _is_declaration(child):
                yield from _nodes(child)


def _is_declaration(node: ast.AST) -> bool:
    if isinstance(node, ast.Expr):
        return isinstance(node.value, ast.Constant)
    if isinstance(node, ast.Assign):  # Name = tuple[...], T = TypeVar(...), __all__ = [...]
        value = node.value
        is_alias = isinstance(value, ast.Subscript) and isinstance(value.value, ast.Name)
        is_variable = isinstance(value, ast.Call) and ast.unparse(value.func) == "TypeVar"
        names = [target.id for target in node.targets if isinstance(target, ast.Name)]
        is_alias = is_alias and ast.unparse(value).startswith(("tuple[", "Callable["))
        return "__all__" in names or is_variable or is_alias
    if isinstance(node, ast.If):
        return ast.unparse(node.test) == "TYPE_CHECKING"
    return isinstance(node, (ast.Import, ast.ImportFrom))
