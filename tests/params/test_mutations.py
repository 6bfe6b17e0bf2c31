# SPDX-License-Identifier: Apache-2.0
"""Each key of each shipped file, broken in every way: the error names file, line and key."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from safety_island.params import SETS, read
from safety_island.params.schema import KNOWN, Known
from safety_island.params.sets import FILES
from tests.params.files import copy_of_set, may_be_missing, refused, shipped_text

_LINE = re.compile(r"^( +)(\w+):(.*)$")
_WRONG_TYPE = {
    "float": ("true", "'0.1'", "~", "[0.1]", "{a: 0.1}"),
    "int": ("5.0", "false", "'5'"),
    "bool": ("1", "0.0", "'true'"),
    "str": ("1", "true", "[mpc]"),
    "list": ("0.1", "'0.1'", "[true]", "['1']", "[[0.1]]"),
}


@dataclass(frozen=True)
class Line:
    """One key of a file: its line number, its indentation and its own name."""

    known: Known
    number: int
    indent: str
    name: str


def lines_of(text: str) -> Iterator[Line]:
    """Yield each line of a file that gives a value."""
    above: dict[int, str] = {}
    for number, line in enumerate(text.splitlines(), 1):
        match = _LINE.match(line)
        if match and (depth := len(match[1])) >= 4:
            above = {at: name for at, name in above.items() if at < depth}
            if not match[3].strip():
                above[depth] = match[2]
                continue
            key = ".".join([*above.values(), match[2]])
            yield Line(KNOWN[key], number, match[1], match[2])


def changed(text: str, lines: dict[int, str | None]) -> str:
    """Return a text with some lines, by their numbers, replaced or taken out."""
    result = [lines.get(number, line) for number, line in enumerate(text.splitlines(), 1)]
    return "\n".join(line for line in result if line is not None) + "\n"


def out_of_range(known: Known) -> list[str]:
    """Values just outside the range, and those that are in no range."""
    if known.kind == "str":
        return ["no_such_choice", "''"] if known.choices else []
    if known.kind == "bool":
        return []
    step = 1 if known.kind == "int" else 1e-6 * max(1.0, abs(known.low), abs(known.high))
    values = [f"{known.low - step}", f"{known.high + step}"]
    if known.kind == "int":
        values = [str(int(float(value))) for value in values]
    values += [".nan", ".inf", "-.inf", "1e400"]
    return [f"[{value}]" for value in values] if known.kind == "list" else values


EVERY_FILE = pytest.mark.parametrize(
    ("set_name", "file"), [(name, file) for name in SETS for file in FILES]
)


@EVERY_FILE
def test_every_key_of_the_file_is_mutated(set_name: str, file: str) -> None:
    keys = [line.known.key for line in lines_of(shipped_text(set_name, file))]
    assert len(keys) == len(set(keys)) > 0


@pytest.mark.parametrize("set_name", SETS)
def test_the_files_of_a_set_hold_every_key(set_name: str) -> None:
    keys = {line.known.key for file in FILES for line in lines_of(shipped_text(set_name, file))}
    assert keys == set(KNOWN)


def wrong_values(known: Known) -> list[str]:
    """Everything that a parameter may not be, as a file writes it."""
    return [*_WRONG_TYPE[known.kind], *out_of_range(known)]


@EVERY_FILE
def test_wrong_values(tmp_path: Path, set_name: str, file: str) -> None:
    text, path = shipped_text(set_name, file), tmp_path / "my.param.yaml"
    lines = list(lines_of(text))
    for i in range(max(len(wrong_values(line.known)) for line in lines)):
        values = {line.number: (v := wrong_values(line.known))[i % len(v)] for line in lines}
        path.write_text(
            changed(text, {n.number: f"{n.indent}{n.name}: {values[n.number]}" for n in lines})
        )
        for line, told in zip(lines, refused([path], set_name), strict=True):
            assert told.startswith(f"{path}:{line.number}: {line.known.key}"), told
            assert re.search(r"found .+; expected .+|is not a known key", told), told


@EVERY_FILE
@pytest.mark.parametrize("twice", ["first", "last"])
def test_misspelt_keys(tmp_path: Path, set_name: str, file: str, twice: str) -> None:
    text, path = shipped_text(set_name, file), tmp_path / "my.param.yaml"
    lines = list(lines_of(text))
    names = {
        n.number: n.name[0] + n.name if twice == "first" else n.name + n.name[-1] for n in lines
    }
    path.write_text(changed(text, {n.number: f"{n.indent}{names[n.number]}: 1" for n in lines}))
    for line, told in zip(lines, refused([path], set_name), strict=True):
        misspelt = line.known.key.removesuffix(line.name) + names[line.number]
        assert told.startswith(f"{path}:{line.number}: {misspelt}: is not a known key"), told
        assert line.known.key in told.split("the nearest known key is ")[1].split(" or "), told


@EVERY_FILE
def test_keys_that_stand_twice(tmp_path: Path, set_name: str, file: str) -> None:
    text, path = shipped_text(set_name, file), tmp_path / "my.param.yaml"
    lines, old = list(lines_of(text)), text.splitlines()
    path.write_text(
        changed(text, {n.number: f"{old[n.number - 1]}\n{old[n.number - 1]}" for n in lines})
    )
    for i, (line, told) in enumerate(zip(lines, refused([path], set_name), strict=True)):
        second = f"{path}:{line.number + i + 1}: {line.known.key}: found a second time, first at "
        assert told.startswith(f"{second}{path}:{line.number + i};"), told


@EVERY_FILE
def test_missing_keys(tmp_path: Path, set_name: str, file: str) -> None:
    files = copy_of_set(set_name, tmp_path)
    text = files[file].read_text()
    section = text.splitlines().index("  ros__parameters:") + 1
    for line in lines_of(text):
        files[file].write_text(changed(text, {line.number: None}))
        if may_be_missing(line.known.key, set_name):
            assert read(list(files.values()), None).origins[line.known.key].source != str(file)
            continue
        (told,) = refused(list(files.values()), None)
        missing = f"{files[file]}:{section}: {line.known.key}: is missing; expected "
        assert told.startswith(missing), told
