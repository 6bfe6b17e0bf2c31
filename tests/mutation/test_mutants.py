# SPDX-License-Identifier: Apache-2.0
"""The mutants are what they say, and a survivor's reason is found again."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from tests.mutation.__main__ import drawn, mutants_of
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
        ("a in (b, c)", {"a not in (b, c)", "a in (c,)", "a in (b,)"}),
        ("a + b", {"a - b"}),
        ("a - b", {"a + b", "b - a"}),
        ("a / b", {"a * b", "b / a"}),
        ("a | b", {"a & b"}),
        ("a and b", {"a or b", "a", "b"}),
        ("a or b or c", {"a and b and c", "b or c", "a or c", "a or b"}),
        ("not a", {"a"}),
        ("-a", {"a"}),
        ("True", {"False"}),
        ("3.5", {"4.5", "0.0"}),
        ("0", {"1"}),
        ("a if b else c", {"c if b else a", "a", "c"}),
        ("[a for a in b if c]", {"[a for a in b if not c]", "[a for a in b]"}),
        ("abs(a)", {"a"}),
        ("math.tan(a)", {"a"}),
        ("clamp(a, b)", {"a", "b", "clamp(b, a)"}),
        ("min(a, b)", {"max(a, b)", "a", "b"}),
        ("max(a, b)", {"min(a, b)", "sum((a, b))", "a", "b"}),
        ("sum(a)", {"max(a)", "a"}),
        ("any(a)", {"all(a)", "a"}),
        ("Point(a, b)", {"Point(b, a)"}),
        ("a.move(b, c)", {"a.move(c, b)"}),
        ("a.move(b, by=c)", {"a.move(b)"}),
        ("a.sent() or b", {"a.sent() and b", "b", "a.sent()", "b or a.sent()"}),
        ("int(a.b)", {"a.b"}),
        ("int(Kind.SOME_ONE)", set()),
        ("len(a)", set()),
        ("isinstance(a, b)", set()),
        ("zip(a, b, strict=c)", set()),
    ],
)
def test_expressions(source: str, mutated: set[str]) -> None:
    assert set(changes(f"x = {source}")) == {*(f"x = {text}" for text in mutated), "pass"}


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("a += 2", {"a -= 2", "pass", "a += 3", "a += 0"}),
        ("a.b: int = c", {"pass"}),
        ("g(a)", {"pass", "a"}),
        ("a.go()", {"pass"}),
        ("raise a", {"pass"}),
        ("raise A(b)", {"pass"}),
        ("for b in c: break", {"for b in (): break", "for b in c: pass"}),
        ("if a: b = c", {f"if {t}: b = c" for t in ("not a", "True", "False")} | {"if a: pass"}),
        ("while a: a = b", {"while a: pass"}),
    ],
)
def test_statements(old: str, new: set[str]) -> None:
    found = set(changes(f"def f(a):\n    {old}\n    return\n"))
    assert found == {ast.unparse(ast.parse(f"def f(a):\n    {text}\n    return\n")) for text in new}


@pytest.mark.parametrize(
    ("kind", "values"),
    [("bool", "True False"), ("int", "None 0"), ("float", "None 0.0"), ("Life", "None")],
)
def test_what_a_function_returns(kind: str, values: str) -> None:
    """Not only a value that no caller can use; and an early return may be left out."""
    text = f"def f(a) -> {kind}:\n    if a:\n        return b\n    return c\n"
    early = [text.replace("return b", new) for new in [*(f"return {v}" for v in values.split())]]
    last = [text.replace("return c", f"return {v}") for v in values.split()]
    wanted = {*early, *last, text.replace("return b", "pass")}
    found = {c for c in changes(text) if "if a:" in c}
    assert found == {ast.unparse(ast.parse(new)) for new in wanted}


def test_the_line_and_the_change_are_told() -> None:
    found = [m.place for m in mutants("f.py", "x = 1\ny = abs(x)\n")]
    assert "f.py:2: `abs(x)` -> `x`" in found and "f.py:1: `1` -> `2`" in found


@pytest.mark.parametrize(
    ("source", "mutant"),
    [
        ("limits = self._strictest(abs(speed))", "limits = self._strictest(speed)"),
        ("went_out = output.send() or went_out", "went_out = went_out or output.send()"),
        ("if due: self._guard.forget()", "if due: pass"),
        ("stop = judge(ramp, engaged=False)", "stop = judge(ramp)"),
        ("x = [i.drop() for i in inputs if i.key != MODE]", "x = [i.drop() for i in inputs]"),
        ("if new and not owner.lives: hand_over()", "if new: hand_over()"),
        ("x = [w for w in lives if w.is_alive]", "x = [w for w in lives]"),
        ("worst = max(faults, crashes)", "worst = sum((faults, crashes))"),
        ("x = not stamp >= 0.0", "x = not stamp < 0.0"),
        ("if full: again()", "if False: again()"),
    ],
)
def test_mutants_that_got_through_once(source: str, mutant: str) -> None:
    """Made by hand, each of them left the tests of its day green."""
    assert ast.unparse(ast.parse(mutant)) in changes(source)


@pytest.mark.parametrize("rate", [0.1, 0.5])
def test_a_sample_is_drawn_by_lot_and_again_for_the_same_seed(rate: float) -> None:
    every = list(mutants("f.py", "x = a + b * c - d / e\n" * 20))
    number = int(rate * len(every))
    sample = drawn(every, number, 7)
    assert len(sample) == number and sample == drawn(every, number, 7) != drawn(every, number, 8)
    assert [every.index(m) for m in sample] == sorted(every.index(m) for m in sample)
    assert drawn(every, None, 1) == drawn(every, 10**6, 1) == every


def test_files_are_chosen_by_name() -> None:
    (guard,) = (room for room in ROOMS if room.name == "guard")
    found = {m.file for m in mutants_of(guard, ["rec*", "limit.py"])}
    assert {Path(name).name for name in found} == {"records.py", "limit.py"}


@pytest.mark.parametrize(
    "source",
    [
        '"""Only a docstring."""',
        "import os",
        "__all__ = ['a']",
        "Pair = tuple[int, int]",
        "Told = Callable[[int], None]",
        "T = TypeVar('T', bound=int)",
        "if TYPE_CHECKING:\n    from a import b",
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
    first, second = (Mutant("a.py", i, "x", f"change {i}", tree, 0, tree) for i in (1, 2))
    excuses = {("a.py", "x", "change 1"): "of no effect"}
    assert (excuse_of(first, excuses), excuse_of(second, excuses)) == ("of no effect", "")
    result = Result("room", 12, [first, second], excuses)
    assert result.unexplained == [second]
    assert "12 mutants, 10 killed, 1 equivalent, 1 survive: **90.9 %**" in result.section()
