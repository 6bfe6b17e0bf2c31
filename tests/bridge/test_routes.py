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

    def make(*texts: str, **overrides: object) -> list[Route]:
        files = []
        for name, text in zip("abcd", texts, strict=False):
            path = tmp_path / f"{name}.yaml"
            path.write_text(text)
            files.append(read_bridge_file(str(path)))
        return plan_routes(files, Overrides(**overrides))  # type: ignore[arg-type]

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
    assert len({route.entry for route in routes}) == 2


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
    (f"a: {{{T}, reversed: true}}", f"a: {{{T}, bidirectional: true}}"),
    (f"a: {{{T}}}", "a: {type: p/msg/Other}"),
]


@pytest.mark.parametrize(("first", "second"), TWINS)
@pytest.mark.parametrize("files", [1, 2])
def test_equal_routes(plan: Plan, first: str, second: str, files: int) -> None:
    head = "from_domain: 1\nto_domain: 2\ntopics:\n"
    texts = (
        [f"{head}  {first}\n  {second}\n"]
        if files == 1
        else [head + f"  {e}" for e in (first, second)]
    )
    here, there = ("a.yaml:5", "a.yaml:4") if files == 1 else ("b.yaml:4", "a.yaml:4")
    with pytest.raises(ConfigurationError) as caught:
        plan(*texts)
    assert f"/{here}: " in str(caught.value)
    assert "is already forwarded by the entry at" in str(caught.value)
    assert str(caught.value).endswith(f"/{there}")


LOOPS = {
    "there and back": [f"a: {{{T}}}", f"a: {{{T}, from_domain: 2, to_domain: 1}}"],
    "there and back, reversed": [f"a: {{{T}}}", f"a: {{{T}, reversed: true}}"],
    "through a remap": [
        f"a: {{{T}, remap: b}}",
        f"b: {{{T}, from_domain: 2, to_domain: 1, remap: a}}",
    ],
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
    "both ways and one more": [
        f"a: {{{T}, bidirectional: true}}",
        f"a: {{{T}, remap: b}}",
        f"b: {{{T}, from_domain: 2, to_domain: 1, remap: a}}",
    ],
}


@pytest.mark.parametrize("name", sorted(LOOPS))
def test_loops(plan: Plan, name: str) -> None:
    head = "from_domain: 1\nto_domain: 2\ntopics:\n"
    with pytest.raises(ConfigurationError, match=r"a\.yaml:\d+: .* closes a loop with"):
        plan(head + "".join(f"  {entry}\n" for entry in LOOPS[name]))


def test_a_loop_over_two_files_names_both(plan: Plan) -> None:
    first = f"topics:\n  a: {{{T}, from_domain: 1, to_domain: 2}}"
    second = f"topics:\n\n  a: {{{T}, from_domain: 2, to_domain: 1}}"
    with pytest.raises(ConfigurationError) as caught:
        plan(first, second)
    assert "b.yaml:3: /a domain 2 -> 1 closes a loop with /a domain 1 -> 2" in str(caught.value)
    assert "a.yaml:2" in str(caught.value)
    assert "bidirectional: true" in str(caught.value)


@pytest.mark.parametrize("name", ["a b", "1a", "a//b", "a/", "a__b", "{node}/a", ""])
def test_names_that_ros_does_not_allow(plan: Plan, name: str) -> None:
    with pytest.raises(ConfigurationError, match=r"a\.yaml:2: topic name .* is not legal"):
        plan(f"topics:\n  '{name}': {{{T}, from_domain: 1, to_domain: 2}}")
    with pytest.raises(ConfigurationError, match=r"a\.yaml:2: topic name .* is not legal"):
        plan(f"topics:\n  a: {{{T}, from_domain: 1, to_domain: 2, remap: '{name}'}}")
