# SPDX-License-Identifier: Apache-2.0
"""Files are taken apart into keys with lines."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safety_island.params.source import Source
from safety_island.params.tree import parse


def keys(text: str) -> dict[str, tuple[object, int | None]]:
    parsed = parse(Source("f.yaml", text))
    assert not parsed.problems
    return {entry.key: (entry.value, entry.place.line) for entry in parsed.entries}


def problem(text: str) -> str:
    parsed = parse(Source("f.yaml", text))
    assert len(parsed.problems) == 1
    return str(parsed.problems[0])


def test_keys_stand_with_their_lines() -> None:
    text = "# head\n/**:\n  ros__parameters:\n    kp: 1.0 # gain\n\n    slope_source: 'raw_pitch'\n"
    assert keys(text) == {"kp": (1.0, 4), "slope_source": ("raw_pitch", 6)}


def test_nested_keys_and_dots_are_the_same() -> None:
    nested = "/**:\n  ros__parameters:\n    vehicle:\n      cf: 1\n      a: {b: [1, 2.5]}\n"
    dotted = "/**:\n  ros__parameters:\n\n    vehicle.cf: 1\n    vehicle.a.b: [1, 2.5]\n"
    assert keys(nested) == keys(dotted) == {"vehicle.cf": (1, 4), "vehicle.a.b": ([1, 2.5], 5)}


@pytest.mark.parametrize(
    "head",
    [
        "/**:\n  ros__parameters:\n",
        "controller_node_exe:\n  ros__parameters:\n",
        "/control/trajectory_follower/controller_node_exe:\n  ros__parameters:\n",
        "control:\n  controller_node_exe:\n    ros__parameters:\n",
    ],
)
def test_any_node_name_may_stand_above(head: str) -> None:
    assert keys(head + "      kp: 2\n") == {"kp": (2, head.count("\n") + 1)}


def test_several_sections_are_read() -> None:
    text = "/**:\n  ros__parameters:\n    kp: 1\nnode:\n  ros__parameters:\n    ki: 2\n"
    assert keys(text) == {"kp": (1, 3), "ki": (2, 6)}


@pytest.mark.parametrize(
    ("text", "line", "part"),
    [
        ("", "f.yaml: ", "found no parameter"),
        ("# only a comment\n", "f.yaml: ", "found no parameter"),
        ("just a text\n", "f.yaml: ", "found no parameter"),
        ("/**:\n  ros__parameters: {}\n", "f.yaml: ", "found no parameter"),
        ("/**:\n  ros__parameters:\n", "f.yaml:2: ", "ros__parameters: has no keys"),
        ("kp: 1.0\n", "f.yaml:1: ", "kp: stands where a node's name is expected"),
        ("/**:\n  kp: 1.0\n", "f.yaml:2: ", "kp: stands where a node's name is expected"),
        ("? [a]\n: {kp: 1}\n", "f.yaml:1: ", "stands where a node's name"),
        ("/**:\n  ros__parameters:\n    kp: 1\n   ki: 2\n", "f.yaml:4: ", "cannot be read as YAML"),
        ("/**:\n\tros__parameters:\n", "f.yaml:2: ", "cannot be read as YAML"),
        ("/**:\n  ros__parameters:\n    kp: [1, 2\n", "f.yaml:4: ", "cannot be read as YAML"),
        ("/**:\n  ros__parameters:\n    kp: &a 1\n", "f.yaml:3: ", "an anchor or alias"),
        ("/**:\n  ros__parameters:\n    b: *a\n", "f.yaml:3: ", "an anchor or alias"),
        ("/**:\n  ros__parameters:\n    kp: !!float 1\n", "f.yaml:3: ", "found a tag"),
        ("a: {ros__parameters: {kp: 1}}\n---\nb: 1\n", "f.yaml:2: ", "another document"),
        ("/**:\n  ros__parameters:\n    kp: \x07\n", "f.yaml: ", "cannot be read as YAML"),
        ("/**:\n  ros__parameters:\n    ? {a: 1}\n    : 2\n", "f.yaml:3: ", "as a key"),
        ("[" * 5000, "f.yaml:1: ", "more than 20 levels"),
        ("a: " + "\n" + "- " * 5000, "f.yaml:2: ", "more than 20 levels"),
    ],
)
def test_what_is_no_parameter_file_is_told(text: str, line: str, part: str) -> None:
    told = problem(text)
    assert told.startswith(line)
    assert part in told
    assert "\n" not in told


@given(st.text(max_size=200))
def test_no_text_at_all_raises(text: str) -> None:
    parsed = parse(Source("f.yaml", text))
    assert parsed.entries or parsed.problems


@given(st.text(alphabet="abkp:-.# []{}&*!'\"\n0123456789e|>?%", max_size=80))
def test_nothing_below_a_section_raises(body: str) -> None:
    parse(Source("f.yaml", f"/**:\n  ros__parameters:\n    {body}"))
