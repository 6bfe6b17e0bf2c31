# SPDX-License-Identifier: Apache-2.0
"""The effective routes of bridge files, and what is refused."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from safety_island.bridge.config_file import read_bridge_file
from safety_island.bridge.routes import Overrides, Route, plan_routes
from safety_island.errors import ConfigurationError

Plan = Callable[..., list[Route]]
T = "type: p/msg/T"


@pytest.fixture
def plan(tmp_path: Path) -> Plan:
    """Plan the routes of texts, each a file of its own (a.yaml, b.yaml, ...)."""

    def make(*texts: str, notes: list[str] | None = None, **overrides: object) -> list[Route]:
        files = []
        for name, text in zip("abcd", texts, strict=False):
            path = tmp_path / f"{name}.yaml"
            path.write_text(text)
            files.append(read_bridge_file(str(path)))
        said = [] if notes is None else notes
        return plan_routes(files, Overrides(**overrides), said.append)  # type: ignore[arg-type]

    return make


def _ends(routes: list[Route]) -> list[tuple[int, str, int, str]]:
    return [(*route.source, *route.target) for route in routes]


def test_names_are_relative_to_the_root(plan: Plan) -> None:
    text = f"name: hal\nfrom_domain: 1\nto_domain: 2\ntopics:\n  a/b: {{{T}}}\n  /c: {{{T}}}\n"
    text += f"  d: {{{T}, remap: e}}\n  f: {{{T}, remap: ~/g}}\n  ~/h: {{{T}}}\n"
    assert _ends(plan(text)) == [
        (1, "/a/b", 2, "/a/b"),
        (1, "/c", 2, "/c"),
        (1, "/d", 2, "/e"),
        (1, "/f", 2, "/hal/g"),
        (1, "/hal/h", 2, "/hal/h"),
    ]


def test_directions(plan: Plan) -> None:
    """As in ROS 2: every direction reads the topic and writes its remap; domains are exchanged."""
    text = f"from_domain: 1\nto_domain: 2\ntopics:\n  a: {{{T}, reversed: true}}\n"
    text += f"  b: {{{T}, bidirectional: true}}\n"
    text += f"  c: {{{T}, bidirectional: true, reversed: true, remap: d}}\n"
    assert _ends(plan(text)) == [
        (2, "/a", 1, "/a"),
        (1, "/b", 2, "/b"),
        (2, "/b", 1, "/b"),
        (2, "/c", 1, "/d"),
        (1, "/c", 2, "/d"),
    ]


def test_options_override_every_entry(plan: Plan) -> None:
    text = f"mode: compress\nfrom_domain: 1\ntopics:\n  a: {{{T}, to_domain: 2}}\n"
    text += f"  b: {{{T}, from_domain: 3, to_domain: 4, reversed: true}}\n"
    routes = plan(text, from_domain=7, to_domain=8, mode="normal")
    assert _ends(routes) == [(7, "/a", 8, "/a"), (8, "/b", 7, "/b")]
    assert {route.mode for route in routes} == {"normal"}


def test_several_files_each_with_its_own_defaults(plan: Plan) -> None:
    first = f"name: one\nmode: compress\nfrom_domain: 1\nto_domain: 2\ntopics: {{~/a: {{{T}}}}}"
    second = f"name: two\nfrom_domain: 3\nto_domain: 4\ntopics: {{~/a: {{{T}}}}}"
    routes = plan(first, second)
    assert _ends(routes) == [(1, "/one/a", 2, "/one/a"), (3, "/two/a", 4, "/two/a")]
    assert [route.mode for route in routes] == ["compress", "normal"]


def test_the_same_topic_to_several_domains_and_names(plan: Plan) -> None:
    text = f"from_domain: 1\nto_domain: 2\ntopics:\n  a: {{{T}}}\n  a: {{{T}, to_domain: 3}}\n"
    text += f"  a: {{{T}, remap: b}}\n"
    assert len(plan(text)) == 3


def test_chains_and_trees_are_no_loops(plan: Plan) -> None:
    text = f"topics:\n  a: {{{T}, from_domain: 1, to_domain: 2, bidirectional: true}}\n"
    text += f"  a: {{{T}, from_domain: 2, to_domain: 3, bidirectional: true}}\n"
    text += f"  a: {{{T}, from_domain: 3, to_domain: 4}}\n"
    text += f"  a: {{{T}, from_domain: 4, to_domain: 1, remap: b}}\n"
    assert len(plan(text)) == 6


@pytest.mark.parametrize("missing", ["from", "to"])
def test_a_domain_is_missing(plan: Plan, missing: str) -> None:
    given = "to_domain: 2" if missing == "from" else "from_domain: 2"
    with pytest.raises(
        ConfigurationError, match=rf"a\.yaml:2: .* no '{missing}_domain'.*--{missing}"
    ):
        plan(f"{given}\ntopics: {{a: {{{T}}}}}")
    assert plan(f"{given}\ntopics: {{a: {{{T}}}}}", **{f"{missing}_domain": 5})


@pytest.mark.parametrize("more", ["", ", reversed: true", ", remap: b", ", bidirectional: true"])
def test_the_same_domain_on_both_ends(plan: Plan, more: str) -> None:
    with pytest.raises(ConfigurationError, match=r"a\.yaml:1: topic 'a' goes from domain 2 to dom"):
        plan(f"topics: {{a: {{{T}, from_domain: 2, to_domain: 2{more}}}}}")


def test_options_can_make_both_ends_the_same(plan: Plan) -> None:
    text = f"from_domain: 1\nto_domain: 2\ntopics: {{a: {{{T}}}}}"
    with pytest.raises(ConfigurationError, match="from domain 2 to domain 2"):
        plan(text, from_domain=2)


TWINS = [
    (f"a: {{{T}}}", f"a: {{{T}}}"),
    (f"a: {{{T}}}", f"/a: {{{T}}}"),
    (f"a: {{{T}}}", f"a: {{{T}, remap: a}}"),
    (f"a: {{{T}, remap: b}}", f"a: {{{T}, remap: /b}}"),
    (f"a: {{{T}, remap: ~/b}}", f"a: {{{T}, remap: domain_bridge/b}}"),
    (f"a: {{{T}}}", f"a: {{{T}, from_domain: 2, to_domain: 1, reversed: true}}"),
    (f"a: {{{T}}}", f"a: {{{T}, remap: ''}}"),
    (f"a: {{{T}}}", f"a: {{{T}, qos: {{depth: 3}}}}"),
]


@pytest.mark.parametrize(("first", "second"), TWINS)
@pytest.mark.parametrize("files", [1, 2])
def test_an_entry_that_stands_there_already_is_noted_and_ignored(
    plan: Plan, first: str, second: str, files: int
) -> None:
    head = "from_domain: 1\nto_domain: 2\ntopics:\n"
    texts = (
        [f"{head}  {first}\n  {second}\n"]
        if files == 1
        else [head + f"  {e}" for e in (first, second)]
    )
    here, there = ("a.yaml:5", "a.yaml:4") if files == 1 else ("b.yaml:4", "a.yaml:4")
    notes: list[str] = []
    routes = plan(*texts, notes=notes)
    assert [str(route.where)[-8:] for route in routes] == ["a.yaml:4"]
    assert len(notes) == 1
    assert f"/{here}: " in notes[0]
    assert f"is already forwarded by the entry at {routes[0].where}" in notes[0]
    assert there in notes[0]


def test_of_an_entry_both_ways_the_direction_that_is_new_counts(plan: Plan) -> None:
    text = f"from_domain: 1\nto_domain: 2\ntopics:\n  a: {{{T}, reversed: true}}\n"
    notes: list[str] = []
    routes = plan(f"{text}  a: {{{T}, bidirectional: true}}\n", notes=notes)
    assert _ends(routes) == [(2, "/a", 1, "/a"), (1, "/a", 2, "/a")]
    assert len(notes) == 1


def test_two_types_for_one_route_are_refused(plan: Plan) -> None:
    text = f"from_domain: 1\nto_domain: 2\ntopics:\n  a: {{{T}}}\n  a: {{type: p/msg/Other}}\n"
    with pytest.raises(ConfigurationError, match=r"a\.yaml:5: .*as p/msg/T instead of p/msg/Other"):
        plan(text)


OPPOSITE = {
    "there and back": [f"a: {{{T}}}", f"a: {{{T}, from_domain: 2, to_domain: 1}}"],
    "there and back, reversed": [f"a: {{{T}}}", f"a: {{{T}, reversed: true}}"],
    "through a remap": [
        f"a: {{{T}, remap: b}}",
        f"b: {{{T}, from_domain: 2, to_domain: 1, remap: a}}",
    ],
    "both ways and one more": [
        f"a: {{{T}, bidirectional: true}}",
        f"a: {{{T}, remap: b}}",
        f"b: {{{T}, from_domain: 2, to_domain: 1, remap: a}}",
    ],
}


@pytest.mark.parametrize("name", sorted(OPPOSITE))
def test_opposite_directions_are_no_loop(plan: Plan, name: str) -> None:
    """A bridge does not hear what it published itself, so they do what 'bidirectional' does."""
    head = "from_domain: 1\nto_domain: 2\ntopics:\n"
    routes = plan(head + "".join(f"  {entry}\n" for entry in OPPOSITE[name]))
    ends = _ends(routes)
    assert all((*end[2:], *end[:2]) in ends for end in ends)


REFERENCE = """\
name: my_bridge
from_domain: 2
to_domain: 3
topics:
  clock:
    type: rosgraph_msgs/msg/Clock
  chatter:
    type: example_interfaces/msg/String
    qos:
      reliability: best_effort
  chatter:
    type: example_interfaces/msg/String
    to_domain: 4
  chatter:
    type: example_interfaces/msg/String
    reversed: True
  chatter:
    type: example_interfaces/msg/String
    from_domain: 7
    to_domain: 8
    bidirectional: True
  chatter:
    type: example_interfaces/msg/String
    remap: chitter
"""


def test_a_file_with_all_that_the_reference_shows(plan: Plan) -> None:
    """Forward, to a second domain, reversed, both ways, remapped."""
    notes: list[str] = []
    assert _ends(plan(REFERENCE, notes=notes)) == [
        (2, "/clock", 3, "/clock"),
        (2, "/chatter", 3, "/chatter"),
        (2, "/chatter", 4, "/chatter"),
        (3, "/chatter", 2, "/chatter"),
        (7, "/chatter", 8, "/chatter"),
        (8, "/chatter", 7, "/chatter"),
        (2, "/chatter", 3, "/chitter"),
    ]
    assert notes == []


LOOPS = {
    "through three domains": [
        f"a: {{{T}}}",
        f"a: {{{T}, from_domain: 2, to_domain: 3}}",
        f"a: {{{T}, from_domain: 3, to_domain: 1}}",
    ],
    "three that go both ways": [
        f"a: {{{T}, bidirectional: true}}",
        f"a: {{{T}, from_domain: 2, to_domain: 3, bidirectional: true}}",
        f"a: {{{T}, from_domain: 3, to_domain: 1, bidirectional: true}}",
    ],
}


@pytest.mark.parametrize("name", sorted(LOOPS))
def test_loops(plan: Plan, name: str) -> None:
    head = "from_domain: 1\nto_domain: 2\ntopics:\n"
    with pytest.raises(ConfigurationError, match=r"a\.yaml:\d+: .* closes a loop with"):
        plan(head + "".join(f"  {entry}\n" for entry in LOOPS[name]))


def test_a_loop_over_two_files_names_both(plan: Plan) -> None:
    first = f"topics:\n  a: {{{T}, from_domain: 1, to_domain: 2}}"
    second = f"topics:\n\n  a: {{{T}, from_domain: 2, to_domain: 3}}\n"
    second += f"  a: {{{T}, from_domain: 3, to_domain: 1}}"
    with pytest.raises(ConfigurationError) as caught:
        plan(first, second)
    assert "b.yaml:4: /a domain 3 -> 1 closes a loop with /a domain 1 -> 2" in str(caught.value)
    assert "a.yaml:2" in str(caught.value)


def test_an_empty_remap_is_none(plan: Plan) -> None:
    text = f"topics:\n  a: {{{T}, from_domain: 1, to_domain: 2, remap: ''}}"
    assert _ends(plan(text)) == [(1, "/a", 2, "/a")]


@pytest.mark.parametrize("name", ["a b", "1a", "a//b", "a/", "a__b", "{node}/a", ""])
def test_names_that_ros_does_not_allow(plan: Plan, name: str) -> None:
    with pytest.raises(ConfigurationError, match=r"a\.yaml:2: topic name .* is not legal"):
        plan(f"topics:\n  '{name}': {{{T}, from_domain: 1, to_domain: 2}}")
    if not name:
        return  # as a remap it is none
    with pytest.raises(ConfigurationError, match=r"a\.yaml:2: topic name .* is not legal"):
        plan(f"topics:\n  a: {{{T}, from_domain: 1, to_domain: 2, remap: '{name}'}}")
