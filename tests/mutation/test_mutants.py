"""The mutants are what they say, and a survivor's reason is found again."""

from __future__ import annotations

import ast

import pytest

from tests.mutation.mutants import Mutant, mutants
from tests.mutation.page import Result, excuse_of, read_excuses
from tests.mutation.runner import ROOMS, ROOT


def changes(source: str) -> list[str]:
    return [ast.unparse(mutant.tree) for mutant in mutants("f.py", source)]


@pytest.mark.parametrize(
    ("source", "mutated"),
    [
        ("a < b", {"a <= b", "a >= b"}),
        ("a < b <= c", {"a <= b <= c", "a >= b <= c", "a < b < c", "a < b > c"}),
        ("a is None", {"a is not None"}),
        ("a + b", {"a - b"}),
        ("a | b", {"a & b"}),
        ("a and b", {"a or b"}),
        ("not a", {"a"}),
        ("-a", {"a"}),
        ("min(a, b)", {"max(a, b)"}),
        ("a if b else c", {"c if b else a"}),
    ],
)
def test_expressions(source: str, mutated: set[str]) -> None:
    assert set(changes(f"x = {source}")) == {*(f"x = {text}" for text in mutated), "pass"}


def test_statements() -> None:
    source = "def f(a):\n    a += 1\n    if a:\n        return a\n    raise g(a)\n"
    assert {text.replace("\n    ", " ; ") for text in changes(source)} == {
        "def f(a): ; a -= 1 ; if a: ;     return a ; raise g(a)",
        "def f(a): ; pass ; if a: ;     return a ; raise g(a)",
        "def f(a): ; a += 2 ; if a: ;     return a ; raise g(a)",
        "def f(a): ; a += 1 ; if not a: ;     return a ; raise g(a)",
        "def f(a): ; a += 1 ; if a: ;     return None ; raise g(a)",
        "def f(a): ; a += 1 ; if a: ;     return a ; pass",
    }


@pytest.mark.parametrize(
    "source",
    [
        '"""Only a docstring."""',
        "import os",
        "__all__ = ['a']",
        "Pair = tuple[int, int]",
        "def f(a: tuple[1]) -> Literal[2]: ...",
    ],
)
def test_what_does_not_run_is_left_alone(source: str) -> None:
    assert changes(source) == []


def test_every_room_has_sources_and_tests() -> None:
    for room in ROOMS:
        assert room.files() and room.paths_of_tests()
        assert not any("golden" in path for path in room.paths_of_tests())


def test_every_reason_belongs_to_a_line_that_stands() -> None:
    """A reason whose line is gone is taken out, lest it excuse something else one day."""
    excuses = read_excuses()
    found = {
        (file, m.source, m.change)
        for file in {file for file, _, _ in excuses}
        for m in mutants(file, (ROOT / file).read_text("utf-8"))
    }
    assert all(excuses.values())
    assert set(excuses) <= found, set(excuses) - found


def test_the_score_leaves_out_what_is_equivalent() -> None:
    tree = ast.parse("")
    first, second = (Mutant("a.py", i, "x", f"change {i}", tree) for i in (1, 2))
    excuses = {("a.py", "x", "change 1"): "of no effect"}
    assert (excuse_of(first, excuses), excuse_of(second, excuses)) == ("of no effect", "")
    result = Result("room", 12, [first, second], excuses)
    assert result.unexplained == [second]
    assert "12 mutants, 10 killed, 1 equivalent, 1 survive: **90.9 %**" in result.section()
