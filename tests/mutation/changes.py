# SPDX-License-Identifier: Apache-2.0
"""The changes that mutants are made of: what a node of the syntax tree may become instead."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from itertools import pairwise

Change = tuple[str, ast.AST]
"""What it says, and what stands in place of the node."""

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
_ORDERED = (ast.Sub, ast.Div, ast.FloorDiv, ast.Mod, ast.Pow)
"""Operators whose operands may not change places."""

_OTHER_FUNCTION = {"min": ("max",), "max": ("min", "sum"), "sum": ("max",)} | {
    "any": ("all",),
    "all": ("any",),
}
_SYMMETRIC = ("min", "max", "isinstance", "getattr", "cast", "range", "zip")
"""Functions whose arguments may change places, or of which nobody would mix them up."""

_KEPT = ("isinstance", "cast", "len", "range", "enumerate", "zip", "super", "getattr", "hasattr")
"""Functions whose argument is of another kind than their result: anything would notice."""

_MEMBER = re.compile(r"int\([A-Z]\w*\.[A-Z][A-Z_0-9]*\)")
"""The number of an enumeration's member, which equals the member."""

_DELETED = (ast.Expr, ast.Assign, ast.AugAssign, ast.Raise, ast.Continue, ast.Break)
_EMPTY: dict[str, tuple[bool | int | float | str | None, ...]] = {
    "bool": (True, False),
    "int": (None, 0),
    "float": (None, 0.0),
    "str": (None, ""),
}
"""What a function may return instead, by the type that it says."""


def changes_of(node: ast.AST, returns: str, is_last: bool) -> Iterator[Change]:
    """Yield every change of a node.

    ``returns`` is the type that the function around it returns; ``is_last`` says that nothing
    follows in that function.
    """
    if isinstance(node, ast.Compare):
        yield from _compare(node)
    elif isinstance(node, ast.BinOp):
        yield from _binary(node)
    elif isinstance(node, ast.AugAssign) and type(node.op) in _BINARY:
        yield told(node, ast.AugAssign(node.target, _BINARY[type(node.op)](), node.value))
    elif isinstance(node, ast.BoolOp):
        yield from _boolean(node)
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.Not, ast.USub)):
        yield told(node, node.operand)
    elif isinstance(node, ast.Constant) and isinstance(node.value, (bool, int, float)):
        yield from _constant(node)
    elif isinstance(node, ast.Return):
        yield from _return(node, returns, is_last)
    elif isinstance(node, ast.IfExp):
        yield told(node, ast.IfExp(node.test, node.orelse, node.body))
        yield told(node, node.body)
        yield told(node, node.orelse)
    elif isinstance(node, ast.If):
        yield from _condition(node)
    elif isinstance(node, ast.comprehension):
        yield from _filters(node)
    elif isinstance(node, ast.For) and not isinstance(node.iter, ast.Tuple):
        iterable = ast.unparse(node.iter)
        yield f"never `for {ast.unparse(node.target)} in {iterable}`", _never(node)
    elif isinstance(node, ast.Call):
        yield from _call(node)
    if isinstance(node, _DELETED) or _sets_attribute(node):
        yield f"delete `{one_line(node)}`", ast.Pass()


def _sets_attribute(node: ast.AST) -> bool:
    is_typed = isinstance(node, ast.AnnAssign) and node.value is not None
    return is_typed and isinstance(node.target, ast.Attribute)  # type: ignore[attr-defined]


def _compare(node: ast.Compare) -> Iterator[Change]:
    for i, op in enumerate(node.ops):
        for other in _COMPARE[type(op)]:
            ops = [*node.ops[:i], other(), *node.ops[i + 1 :]]
            yield told(node, ast.Compare(node.left, ops, node.comparators))
        members = node.comparators[i]
        if isinstance(op, (ast.In, ast.NotIn)) and isinstance(members, (ast.Tuple, ast.Set)):
            for k, member in enumerate(members.elts):
                fewer = ast.Tuple([*members.elts[:k], *members.elts[k + 1 :]], ast.Load())
                comparators = [*node.comparators[:i], fewer, *node.comparators[i + 1 :]]
                change = ast.Compare(node.left, node.ops, comparators)
                yield f"`{one_line(node)}` without `{one_line(member)}`", change


def _binary(node: ast.BinOp) -> Iterator[Change]:
    if type(node.op) in _BINARY:
        yield told(node, ast.BinOp(node.left, _BINARY[type(node.op)](), node.right))
    if isinstance(node.op, _ORDERED) and not isinstance(node.left, (ast.Constant, ast.JoinedStr)):
        yield told(node, ast.BinOp(node.right, node.op, node.left))


def _boolean(node: ast.BoolOp) -> Iterator[Change]:
    """The other operator, an operand left out, and another order where operands do something."""
    other = ast.Or() if isinstance(node.op, ast.And) else ast.And()
    yield told(node, ast.BoolOp(other, node.values))
    for i, operand in enumerate(node.values):
        rest = [*node.values[:i], *node.values[i + 1 :]]
        fewer = rest[0] if len(rest) == 1 else ast.BoolOp(node.op, rest)
        yield f"`{one_line(node)}` without `{one_line(operand)}`", fewer
    for i, (one, following) in enumerate(pairwise(node.values)):
        if any(_acts(part) for part in (*ast.walk(one), *ast.walk(following))):
            swapped = [*node.values[:i], following, one, *node.values[i + 2 :]]
            change = f"`{one_line(following)}` before `{one_line(one)}`"
            yield change, ast.BoolOp(node.op, swapped)


def _acts(node: ast.AST) -> bool:
    """Whether a node may do something: it calls a method; a function like ``abs`` only answers."""
    return isinstance(node, ast.Call) and not _gives_what_it_gets(node.func)


def _constant(node: ast.Constant) -> Iterator[Change]:
    value = node.value
    if isinstance(value, bool):
        yield told(node, ast.Constant(not value))
    elif isinstance(value, (int, float)):
        yield told(node, ast.Constant(value + 1))
        if value not in (0, -1):
            yield told(node, ast.Constant(type(value)(0)))


def _return(node: ast.Return, returns: str, is_last: bool) -> Iterator[Change]:
    if node.value is not None:
        for value in _EMPTY.get(returns, (None,)):
            yield told(node, ast.Return(ast.Constant(value)))
    if not is_last:
        yield f"delete `{one_line(node)}`", ast.Pass()


def _condition(node: ast.If) -> Iterator[Change]:
    old = f"`if {one_line(node.test)}`"
    negated = ast.UnaryOp(ast.Not(), node.test)
    for test in (negated, ast.Constant(True), ast.Constant(False)):
        yield f"{old} -> `if {one_line(test)}`", ast.If(test, node.body, node.orelse)


def _filters(node: ast.comprehension) -> Iterator[Change]:
    for i, test in enumerate(node.ifs):
        for new in ([ast.UnaryOp(ast.Not(), test)], []):
            ifs = [*node.ifs[:i], *new, *node.ifs[i + 1 :]]
            shown = f"`if {one_line(new[0])}`" if new else "no condition"
            change = ast.comprehension(node.target, node.iter, ifs, node.is_async)
            yield f"`if {one_line(test)}` -> {shown}", change


def _never(node: ast.For) -> ast.For:
    return ast.For(node.target, ast.Tuple([], ast.Load()), node.body, node.orelse)


def _call(node: ast.Call) -> Iterator[Change]:
    """Another function, an argument in place of the call, arguments swapped or left out."""
    name = node.func.id if isinstance(node.func, ast.Name) else ""
    for other in _OTHER_FUNCTION.get(name, ()):
        arguments: list[ast.expr] = list(node.args)
        if other == "sum" and len(arguments) > 1:
            arguments = [ast.Tuple(arguments, ast.Load())]
        if other != "max" or name != "sum" or len(arguments) == 1:
            yield told(node, ast.Call(ast.Name(other, ast.Load()), arguments, node.keywords))
    positional = [arg for arg in node.args if not isinstance(arg, ast.Starred)]
    if (
        len(positional) == len(node.args)
        and _gives_what_it_gets(node.func)
        and not _is_number_of_member(node)
    ):
        for argument in positional:
            yield told(node, argument)
    if name not in _SYMMETRIC and len(positional) == len(node.args):
        for i, (one, following) in enumerate(pairwise(positional)):
            swapped = [*positional[:i], following, one, *positional[i + 2 :]]
            yield told(node, ast.Call(node.func, swapped, node.keywords))
    for i, keyword in enumerate(node.keywords):
        if keyword.arg not in (None, "strict"):
            fewer = [*node.keywords[:i], *node.keywords[i + 1 :]]
            yield (
                f"`{one_line(node)}` without `{keyword.arg}`",
                ast.Call(node.func, node.args, fewer),
            )


def _is_number_of_member(node: ast.Call) -> bool:
    """Whether a call is such as ``int(Reason.NONE)``: the member of an enumeration equals it."""
    return _MEMBER.fullmatch(ast.unparse(node)) is not None


def _gives_what_it_gets(function: ast.expr) -> bool:
    """Whether an argument may stand for the call: a function, not a class and not a method."""
    if isinstance(function, ast.Name):
        return function.id not in _KEPT and not function.id.lstrip("_")[:1].isupper()
    is_module = isinstance(function, ast.Attribute) and isinstance(function.value, ast.Name)
    return is_module and function.value.id in ("math", "np")  # type: ignore[attr-defined]


def told(old: ast.AST, new: ast.AST) -> Change:
    """Return a change as both nodes say it."""
    return f"`{one_line(old)}` -> `{one_line(new)}`", new


def one_line(node: ast.AST) -> str:
    """Return a node as text, cut when it is long."""
    text = " ".join(ast.unparse(ast.fix_missing_locations(node)).split())
    return text if len(text) <= 70 else text[:67] + "..."
