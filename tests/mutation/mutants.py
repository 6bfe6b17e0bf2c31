"""Every small change of a Python source that a good test should notice."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import dataclass

_COMPARE: dict[type[ast.cmpop], tuple[type[ast.cmpop], ...]] = {
    ast.Lt: (ast.LtE, ast.GtE),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
}
_BINARY: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Mult,
    ast.Mod: ast.Mult,
    ast.Pow: ast.Mult,
    ast.LShift: ast.RShift,
    ast.RShift: ast.LShift,
    ast.BitOr: ast.BitAnd,
    ast.BitAnd: ast.BitOr,
}
_CALLS = {"min": "max", "max": "min", "any": "all", "all": "any"}
_DELETED = (ast.Expr, ast.Assign, ast.AugAssign, ast.Raise, ast.Continue, ast.Break)


@dataclass(frozen=True)
class Mutant:
    """A source with one change, as a tree; ``source`` is the line that the change is in."""

    file: str
    line: int
    source: str
    change: str
    tree: ast.AST


def mutants(file: str, text: str) -> Iterator[Mutant]:
    """Yield every mutant of a source text, in the order of its lines."""
    tree, lines = ast.parse(text), text.splitlines()
    found: list[Mutant] = []
    for index, node in enumerate(_nodes(tree)):
        for change, replacement in _replacements(node):
            if ast.dump(replacement) == ast.dump(node):
                continue
            copy = deepcopy(tree)
            victim = list(_nodes(copy))[index]
            mutated = ast.fix_missing_locations(_Replace(victim, replacement).visit(copy))
            line = getattr(node, "lineno", 1)
            found.append(Mutant(file, line, lines[line - 1].strip(), change, mutated))
    yield from sorted(found, key=lambda mutant: mutant.line)


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
    if isinstance(node, ast.Assign):  # Name = tuple[...], __all__ = [...]
        value = node.value
        is_alias = isinstance(value, ast.Subscript) and isinstance(value.value, ast.Name)
        names = [target.id for target in node.targets if isinstance(target, ast.Name)]
        return "__all__" in names or (is_alias and ast.unparse(value).startswith("tuple["))
    return isinstance(node, (ast.Import, ast.ImportFrom))


def _replacements(node: ast.AST) -> Iterator[tuple[str, ast.AST]]:
    if isinstance(node, ast.Compare):
        yield from _compare(node)
    elif isinstance(node, ast.BinOp) and type(node.op) in _BINARY:
        new = _BINARY[type(node.op)]()
        yield _told(node, ast.BinOp(node.left, new, node.right))
    elif isinstance(node, ast.AugAssign) and type(node.op) in _BINARY:
        yield _told(node, ast.AugAssign(node.target, _BINARY[type(node.op)](), node.value))
    elif isinstance(node, ast.BoolOp):
        other = ast.Or() if isinstance(node.op, ast.And) else ast.And()
        yield _told(node, ast.BoolOp(other, node.values))
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.Not, ast.USub)):
        yield _told(node, node.operand)
    elif isinstance(node, ast.Constant) and isinstance(node.value, (bool, int, float)):
        is_switch = isinstance(node.value, bool)
        yield _told(node, ast.Constant(not node.value if is_switch else node.value + 1))
    elif isinstance(node, ast.Return) and node.value is not None:
        yield _told(node, ast.Return(ast.Constant(None)))
    elif isinstance(node, ast.IfExp):
        yield _told(node, ast.IfExp(node.test, node.orelse, node.body))
    elif isinstance(node, ast.If):
        yield _condition(node)
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in _CALLS:
        function = ast.Name(_CALLS[node.func.id], ast.Load())
        yield _told(node, ast.Call(function, node.args, node.keywords))
    if isinstance(node, _DELETED):
        yield f"delete `{_one_line(node)}`", ast.Pass()


def _compare(node: ast.Compare) -> Iterator[tuple[str, ast.AST]]:
    for i, op in enumerate(node.ops):
        for other in _COMPARE[type(op)]:
            ops = [*node.ops[:i], other(), *node.ops[i + 1 :]]
            yield _told(node, ast.Compare(node.left, ops, node.comparators))


def _condition(node: ast.If) -> tuple[str, ast.AST]:
    test = ast.UnaryOp(ast.Not(), node.test)
    change = f"`if {ast.unparse(node.test)}` -> `if {ast.unparse(test)}`"
    return change, ast.If(test, node.body, node.orelse)


def _told(old: ast.AST, new: ast.AST) -> tuple[str, ast.AST]:
    return f"`{_one_line(old)}` -> `{_one_line(new)}`", new


def _one_line(node: ast.AST) -> str:
    text = " ".join(ast.unparse(ast.fix_missing_locations(node)).split())
    return text if len(text) <= 70 else text[:67] + "..."
