# SPDX-License-Identifier: Apache-2.0
"""Peers that announce type information: recent rmw_cyclonedds, and CycloneDDS 0.10 in C."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from cyclonedds.builtin import (
    BuiltinDataReader,
    BuiltinTopicDcpsPublication,
    BuiltinTopicDcpsSubscription,
)
from cyclonedds.domain import DomainParticipant

from safety_island.dds import topics
from safety_island.dds.qos import DEFAULT, LATCHED, Qos
from safety_island.dds.raw_topic import OpaqueTopic
from safety_island.messages import codec, inputs, registry
from tests.dds.conftest import NewParticipant
from tests.dds.dynamic_types import topic_of
from tests.dds.peer import line, module
from tests.dds.waiting import wait_for
from tests.interop.namespace import Running

pytestmark = pytest.mark.live
BEST_EFFORT = Qos("best_effort")
MATCHED = "2 2"
"""The peer's own reader and writer, and ours."""
OLD = {
    "CYCLONEDDS_URI": '<CycloneDDS><Domain Id="any"><General><AllowMulticast>false</AllowMulticast>'
    '<Interfaces><NetworkInterface name="lo"/></Interfaces></General><Discovery><Peers>'
    '<Peer address="127.0.0.1"/></Peers></Discovery></Domain></CycloneDDS>'
}


@pytest.mark.parametrize("opaque", [False, True], ids=["typed", "unknown type"])
def test_every_type_matches_in_both_directions(
    opaque: bool, participant: NewParticipant, domain_id: int
) -> None:
    own = participant()
    ends = []
    for name in registry.names():
        topic = topic_of(name)
        if opaque:
            made = OpaqueTopic(own.handle, f"rt{topic}", name)
            own._topics[f"rt{topic}", name] = made
        publisher = own.publisher(topic, name, DEFAULT)
        ends.append((publisher, own.subscription(topic, name, BEST_EFFORT, ignore_own=True)))
    with module("tests.dds.dynamic_types", str(domain_id), *registry.names()) as peer:
        missing = set(registry.names())
        while missing:
            name, _, counts = line(peer).partition(" ")
            if counts == MATCHED:
                missing.discard(name)
        for publisher, subscription in ends:
            wait_for(publisher.matched)
            wait_for(subscription.matched)


@pytest.fixture(scope="module")
def typed_program(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Compile the peer and its types with CycloneDDS 0.10."""
    if not Path("/usr/include/dds/dds.h").exists() or not all(map(shutil.which, ("cc", "idlc"))):
        pytest.skip("no CycloneDDS in C on this machine (Debian: cyclonedds-dev, cyclonedds-tools)")
    folder, here = tmp_path_factory.mktemp("typed"), Path(__file__).parent
    subprocess.run(["idlc", "-l", "c", here / "operation_mode.idl"], cwd=folder, check=True)
    sources = (str(here / "typed_peer.c"), "operation_mode.c")
    command = ["cc", "-I.", "-o", "typed_peer", *sources, "-lddsc"]
    subprocess.run(command, cwd=folder, check=True)
    return str(folder / "typed_peer")


@pytest.fixture
def typed_peer(typed_program: str, domain_id: int) -> Iterator[Callable[[str], Running]]:
    """Start the peer, with ROS's name of the type or the one in its .idl file."""
    with ExitStack() as stack:

        def start(naming: str) -> Running:
            topic = f"rt{topics.OPERATION_MODE.name}"
            running = Running([typed_program, str(domain_id), topic, naming], OLD)
            stack.callback(running.close)
            return running

        yield start


def test_a_typed_program_with_cyclonedds_0_10_lives_and_exchanges_samples(
    participant: NewParticipant, typed_peer: Callable[[str], Running]
) -> None:
    own, entry = participant(), topics.OPERATION_MODE
    peer = typed_peer("ros")
    publisher = own.publisher(entry.name, entry.type_name, LATCHED)
    subscription = own.subscription(entry.name, entry.type_name, LATCHED, ignore_own=True)
    peer.expect(lambda line: line == "matched 1 1")
    for mode in range(1, 6):
        assert publisher.write(_mode(mode))
        peer.expect(f"received {mode}".__eq__)
        sample = wait_for(subscription.take_newest)
        assert codec.decode(entry.type_name, sample.data)["mode"] == 7
    assert own.mismatches() == []
    assert peer.process.poll() is None


def test_a_type_under_another_name_does_not_match_and_is_said_to(
    participant: NewParticipant, typed_peer: Callable[[str], Running]
) -> None:
    """Its members are the same; to take its samples, and to warn of it, were two truths."""
    own, entry = participant(), topics.OPERATION_MODE
    publisher = own.publisher(entry.name, entry.type_name, LATCHED)
    subscription = own.subscription(entry.name, entry.type_name, LATCHED, ignore_own=True)
    other, right = typed_peer("plain"), typed_peer("ros")
    wait_for(lambda: len(own.publications(entry.name)) == 2)
    right.expect(lambda line: line == "matched 1 1")
    assert publisher.write(_mode(3))
    right.expect(lambda line: line == "received 3")
    (writer,) = own.writers(entry.name, entry.type_name)
    for _ in range(5):
        sample = wait_for(subscription.take_newest)
        assert sample.writer_guid == writer
    assert (publisher.matched(), subscription.matched()) == (1, 1)
    (found, _) = own.mismatches()
    assert "has type autoware_adapi_v1_msgs::msg::OperationModeState, expected" in found
    assert other.expect(lambda line: line == "matched 0 0")


def _mode(mode: int) -> bytes:
    name = topics.OPERATION_MODE.type_name
    return codec.encode(name, {**codec.default(name), "mode": mode})


def test_no_endpoint_announces_type_information(participant: NewParticipant) -> None:
    own = participant()
    peer = DomainParticipant(own.domain_id)
    publisher = own.publisher("/a", inputs.OPERATION_MODE)
    subscription = own.subscription("/a", inputs.OPERATION_MODE)
    for kind, guid in (
        (BuiltinTopicDcpsPublication, publisher.guid),
        (BuiltinTopicDcpsSubscription, subscription.guid),
    ):
        reader = BuiltinDataReader(peer, kind)
        known: dict[bytes, Any] = {}

        def is_found(reader: Any = reader, known: Any = known, guid: bytes = guid) -> bool:
            known.update({sample.key.bytes: sample for sample in reader.read(256)})
            return guid in known

        wait_for(is_found)
        announced = [found for found in known.values() if found.participant_key.bytes == own.guid]
        assert announced and all(found.type_id is None for found in announced)
