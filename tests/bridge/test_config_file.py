# SPDX-License-Identifier: Apache-2.0
"""The bridge file: the whole schema, and every complaint with file and line."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from safety_island.bridge.config_file import AUTO, BridgeFile, Keep, QosWish, read_bridge_file
from safety_island.errors import ConfigurationError

EVERYTHING = """\
name: my_bridge
from_domain: 2
to_domain: 3
mode: compress
topics:
  clock:
    type: rosgraph_msgs/msg/Clock
  chatter:
    type: example_interfaces/msg/String
    from_domain: 4
    to_domain: 5
    remap: ~/chitter
    bidirectional: true
    reversed: true
    qos:
      reliability: best_effort
      durability: transient_local
      history: keep_all
      depth: 3
      deadline: auto
      lifespan: 1000000
      liveliness: manual_by_topic
      liveliness_lease_duration: 2000000
"""


def _read(folder: Path, text: str) -> BridgeFile:
    path = folder / "bridge.yaml"
    path.write_text(text)
    return read_bridge_file(str(path))


def test_reads_every_key(tmp_path: Path) -> None:
    file = _read(tmp_path, EVERYTHING)
    assert (file.name, file.mode) == ("my_bridge", "compress")
    clock, chatter = file.entries
    assert (clock.topic, clock.type_name) == ("clock", "rosgraph_msgs/msg/Clock")
    assert (clock.from_domain, clock.to_domain, clock.remap) == (2, 3, None)
    assert (clock.bidirectional, clock.reversed, clock.qos) == (False, False, QosWish())
    assert (chatter.from_domain, chatter.to_domain, chatter.remap) == (4, 5, "~/chitter")
    assert chatter.bidirectional
    assert chatter.reversed
    assert chatter.qos == QosWish(
        reliability="best_effort",
        durability="transient_local",
        history="keep_all",
        depth=3,
        deadline=AUTO,
        lifespan=1_000_000,
        liveliness="manual_by_topic",
        lease=2_000_000,
    )
    assert str(chatter.where).endswith("bridge.yaml:8")


def test_defaults(tmp_path: Path) -> None:
    file = _read(tmp_path, "topics: {a: {type: p/msg/T}}")
    assert (file.name, file.mode) == ("domain_bridge", "normal")
    assert file.entries[0].qos == QosWish(history=None, depth=None)
    assert (file.entries[0].keep, file.entries[0].delay_s) == (Keep(), 0.0)
    assert file.notes == ()
    assert (file.entries[0].from_domain, file.entries[0].to_domain) == (None, None)


def test_a_topic_may_stand_several_times(tmp_path: Path) -> None:
    """Duplicate keys are legal here, and each of them counts."""
    text = (
        "from_domain: 2\nto_domain: 3\ntopics:\n"
        "  chatter: {type: p/msg/T}\n"
        "  chatter: {type: p/msg/T, to_domain: 4}\n"
        "  chatter: {type: p/msg/T, remap: chitter}\n"
    )
    entries = _read(tmp_path, text).entries
    assert [(e.topic, e.to_domain, e.remap) for e in entries] == [
        ("chatter", 3, None),
        ("chatter", 4, None),
        ("chatter", 3, "chitter"),
    ]


@pytest.mark.parametrize("value", ["-1", "0", "-9223372036854775807"])
def test_negative_durations_are_infinite(tmp_path: Path, value: str) -> None:
    qos = f"{{deadline: {value}, lifespan: {value}, liveliness_lease_duration: {value}}}"
    wish = _read(tmp_path, f"topics: {{a: {{type: p/msg/T, qos: {qos}}}}}").entries[0].qos
    assert (wish.deadline, wish.lifespan, wish.lease) == (None, None, None)


def test_the_lease_is_not_the_lifespan(tmp_path: Path) -> None:
    """In ROS 2's program this key sets the lifespan."""
    qos = "{liveliness_lease_duration: 5}"
    wish = _read(tmp_path, f"topics: {{a: {{type: p/msg/T, qos: {qos}}}}}").entries[0].qos
    assert (wish.lifespan, wish.lease) == (None, 5)


def test_anchors_may_be_shared(tmp_path: Path) -> None:
    text = "topics:\n  a: {type: p/msg/T, qos: &q {depth: 1}}\n  b: {type: p/msg/T, qos: *q}\n"
    assert [entry.qos.depth for entry in _read(tmp_path, text).entries] == [1, 1]


REFUSED = [
    ("- a\n", 1, "the bridge file is a list, expected a map"),
    ("a: [\n", 2, "not YAML"),
    ("topics: {a: {type: p/msg/T}}\n---\ntopics: {}\n", 2, "not YAML: but found another document"),
    ("topics: [a]\n", 1, "'topics' is a list, expected a map"),
    ("topics:\n  a: 3\n", 2, "topic 'a' is '3', expected a map"),
    ("topics:\n  a:\n", 2, "topic 'a' is empty, expected a map"),
    ("topics:\n  ? [a]\n  : {}\n", 2, "a key is a list, expected a word"),
    ("tpics: {a: {}}\n", 1, "unknown key 'tpics' in the bridge file; did you mean 'topics'?"),
    ("servces: {a: {}}\n", 1, "unknown key 'servces' in the bridge file; did you mean 'services"),
    ("what: {a: {}}\n", 1, "unknown key 'what' in the bridge file; known: name,"),
    ("mode: normal\nmode: normal\ntopics: {}\n", 2, "key 'mode' stands twice"),
    ("mode: compres\ntopics: {}\n", 1, "mode is 'compres', expected normal or compress"),
    ("mode: 1\ntopics: {}\n", 1, "mode is '1', expected normal or compress"),
    ("mode: 'a\n\n  b'\ntopics: {}\n", 1, "mode is 'a b', expected normal"),
    ("name: my-bridge\ntopics: {a: {type: p/msg/T}}\n", 1, "name is 'my-bridge'"),
    ("from_domain: 233\ntopics: {a: {type: p/msg/T}}\n", 1, "from_domain is '233', expected a"),
    ("to_domain: -1\ntopics: {a: {type: p/msg/T}}\n", 1, "to_domain is '-1'"),
    ("to_domain: '-1'\ntopics: {a: {type: p/msg/T}}\n", 1, "to_domain is '-1'"),
    ("to_domain: !!int x\ntopics: {a: {type: p/msg/T}}\n", 1, "to_domain is 'x'"),
    (f"to_domain: {'9' * 5000}\ntopics: {{}}\n", 1, f"to_domain is '{'9' * 60}' and more"),
    ("to_domain: yes\ntopics: {a: {type: p/msg/T}}\n", 1, "to_domain is 'yes', expected a DDS"),
    ("to_domain: 'two'\ntopics: {a: {type: p/msg/T}}\n", 1, "to_domain is 'two', expected a"),
    ("topics:\n  a:\n    from_domain: 1\n", 2, "topic 'a' has no 'type'"),
    ("topics:\n  a:\n    type: T\n", 3, "type is 'T', expected package/msg/Name"),
    ("topics:\n  a:\n    type: p/srv/T\n", 3, "type is 'p/srv/T', expected package/msg/Name"),
    ("topics:\n  a: {type: p/msg/T, remp: b}\n", 2, "did you mean 'remap'?"),
    ("topics:\n  a: {type: p/msg/T,\n type: p/msg/T}\n", 3, "key 'type' stands twice"),
    ("topics:\n  a: {type: p/msg/T, reversed: 1}\n", 2, "reversed is '1', expected true or false"),
    ("topics:\n  a: {type: p/msg/T, bidirectional: both}\n", 2, "bidirectional is 'both'"),
    ("topics:\n  a: {type: p/msg/T, reversed: !!bool 3}\n", 2, "reversed is '3', expected true"),
    ("topics:\n  a: {type: p/msg/T, delay: -1}\n", 2, "delay is '-1', expected milliseconds"),
    ("topics:\n  a: {type: p/msg/T, publisher: x y}\n", 2, "publisher is 'x y', expected a node"),
    ("topics:\n  a: {type: p/msg/T, second_publisher: first}\n", 2, "did you mean 'keep_first'?"),
    ("topics:\n  a: {type: p/msg/T, remap: [b]}\n", 2, "remap is a list, expected a string"),
    ("topics:\n  a: {type: p/msg/T, remap: }\n", 2, "remap is empty, expected a string"),
]
REFUSED_QOS = [
    ("[reliable]", "'qos' of topic 'a' is a list, expected a map"),
    ("{reliabilty: reliable}", "did you mean 'reliability'?"),
    ("{reliability: reliabel}", "reliability is 'reliabel', expected reliable or best_effort"),
    ("{durability: persistent}", "durability is 'persistent', expected volatile or"),
    ("{history: keep_first}", "did you mean 'keep_last'?"),
    ("{depth: -1}", "depth is '-1', expected samples to keep: a whole number from 0"),
    ("{depth: 1.5}", "depth is '1.5', expected samples to keep"),
    ("{depth: many}", "depth is 'many', expected samples to keep"),
    ("{deadline: soon}", "deadline is 'soon', expected nanoseconds (negative: infinite) or 'auto'"),
    ("{lifespan: 0.5}", "lifespan is '0.5', expected nanoseconds"),
    ("{lifespan: 9223372036854775808}", "lifespan is '9223372036854775808'"),
    ("{liveliness: manual}", "liveliness is 'manual', expected automatic or manual_by_topic"),
    ("{liveliness_lease_duration: auto}", "liveliness_lease_duration is 'auto', expected nano"),
]


@pytest.mark.parametrize(("text", "line", "problem"), REFUSED)
def test_refuses_with_the_line(tmp_path: Path, text: str, line: int, problem: str) -> None:
    with pytest.raises(ConfigurationError) as caught:
        _read(tmp_path, text)
    message = str(caught.value)
    assert message.startswith(f"{tmp_path}/bridge.yaml:{line}: ")
    assert problem in message
    assert "\n" not in message


@pytest.mark.parametrize(("qos", "problem"), REFUSED_QOS)
def test_refuses_qos_with_the_line(tmp_path: Path, qos: str, problem: str) -> None:
    text = f"topics:\n  a:\n    type: p/msg/T\n    qos: {qos}\n"
    with pytest.raises(ConfigurationError) as caught:
        _read(tmp_path, text)
    assert "bridge.yaml:4: " in str(caught.value)
    assert problem in str(caught.value)


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match=r"cannot read bridge file .*none\.yaml: No such"):
        read_bridge_file(str(tmp_path / "none.yaml"))


def test_a_file_that_is_no_text(tmp_path: Path) -> None:
    path = tmp_path / "bridge.yaml"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ConfigurationError, match="not UTF-8 text"):
        read_bridge_file(str(path))


@pytest.mark.parametrize("text", ["", "# nothing\n", "name: x\n", "topics:\n", "topics: {}\n"])
def test_a_file_without_topics_is_noted(tmp_path: Path, text: str) -> None:
    file = _read(tmp_path, text)
    assert file.entries == ()
    assert file.notes == (f"{tmp_path}/bridge.yaml: no topics in this file, it forwards nothing",)


@pytest.mark.parametrize("section", ["services", "actions"])
def test_what_is_not_bridged_is_noted_and_the_topics_count(tmp_path: Path, section: str) -> None:
    file = _read(
        tmp_path, f"{section}:\n  a: {{type: p/srv/T}}\ntopics: {{a: {{type: p/msg/T}}}}\n"
    )
    assert len(file.entries) == 1
    assert file.notes == (f"{tmp_path}/bridge.yaml:2: {section} are not bridged, only topics are",)


def test_quotes_make_no_difference(tmp_path: Path) -> None:
    """As for yaml-cpp, which reads the files of ROS 2's program."""
    text = """topics:
      "a":
        type: 'p/msg/T'
        from_domain: "1"
        to_domain: '2'
        reversed: "True"
        bidirectional: 'no'
        qos: {depth: "3", lifespan: '4', deadline: "auto", reliability: "reliable"}
    """
    entry = _read(tmp_path, text).entries[0]
    assert (entry.from_domain, entry.to_domain) == (1, 2)
    assert (entry.reversed, entry.bidirectional) == (True, False)
    assert (entry.qos.depth, entry.qos.lifespan, entry.qos.deadline) == (3, 4, AUTO)


def test_system_defaults(tmp_path: Path) -> None:
    """ROS 2 takes a depth of 0 for the middleware's default, which is 1 with CycloneDDS."""
    text = "topics: {a: {type: p/msg/T, qos: {liveliness: system_default, depth: 0}}}"
    assert _read(tmp_path, text).entries[0].qos == QosWish(liveliness=None, depth=1)


@pytest.mark.parametrize(
    ("text", "keep"),
    [
        ("second_publisher: keep_first", Keep("", "keep_first")),
        ("second_publisher: silent", Keep("", "silent")),
        ("publisher: /a/b_c", Keep("/a/b_c")),
        ("publisher: 0123456789ABCDEF0123456789abcdef", Keep("0123456789abcdef" * 2)),
        (
            "publisher: 01.10.1f.01.74.12.2c.8c.30.46.c7.06.00.00.06.03.00.00.00.00.00.00.00.00",
            Keep("01101f0174122c8c3046c70600000603"),
        ),
    ],
)
def test_the_publisher_that_a_topic_keeps_to(tmp_path: Path, text: str, keep: Keep) -> None:
    file = _read(tmp_path, f"topics:\n  a:\n    type: p/msg/T\n    delay: 250\n    {text}\n")
    assert (file.entries[0].keep, file.entries[0].delay_s) == (keep, 0.25)


@pytest.mark.parametrize("opening", ["[", "{a: ", "- ", "? "])
def test_brackets_without_end_are_one_line(tmp_path: Path, opening: str) -> None:
    with pytest.raises(ConfigurationError) as caught:
        _read(tmp_path, "name: x\ntopics:\n  " + opening * 2000)
    message = str(caught.value)
    assert f"{tmp_path}/bridge.yaml:3: more than 32 levels of lists and maps" in message
    assert "\n" not in message


def test_what_refers_to_itself_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match="unknown key 'a' in topic 'a'"):
        _read(tmp_path, "topics: &t {a: *t}")


def test_no_text_is_a_fault_of_ours(tmp_path: Path) -> None:
    """Files that were cut, mixed up and torn are read, or refused in one line."""
    chance = random.Random(70)
    pieces = [*EVERYTHING.splitlines(keepends=True), "[", "}", "*a", "&a ", "!!int ", "\t", "<<: "]
    pieces += ["\x00", "\ud7ff", "? ", "- ", "|\n", "'", "%YAML 9\n", "---\n", "...\n", "\ufeff"]
    for _ in range(300):
        text = "".join(chance.choices(pieces, k=chance.randrange(1, 25)))
        try:
            _read(tmp_path, text[: chance.randrange(len(text) + 1)])
        except ConfigurationError as refused:
            assert "\n" not in str(refused)
