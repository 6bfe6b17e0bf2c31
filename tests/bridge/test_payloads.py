# SPDX-License-Identifier: Apache-2.0
"""What passes: types that nobody here knows, compressed samples, and nothing that is broken."""

from __future__ import annotations

import gc
import struct
from typing import Any

from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import make_idl_struct
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy
from cyclonedds.qos import Qos as CycloneQos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic

from safety_island.dds.endpoints import Publisher, Subscription
from safety_island.dds.qos import Qos
from safety_island.messages.inputs import STEERING, Steering, encode_steering
from safety_island.messages.wire import Time
from tests.bridge.conftest import Rig

STRING = "example_interfaces/msg/String"
COMPRESSED = "domain_bridge/msg/CompressedMsg"
DEEP = Qos(depth=64)


def _entry(source: str, target: str, type_name: str = STRING) -> str:
    entry = f"{{type: {type_name}, from_domain: {source}, to_domain: {target}}}"
    return f"topics:\n  /t: {entry}\n"


def _text(text: str) -> bytes:
    body = text.encode() + b"\0"
    message = b"\x00\x01\x00\x00" + struct.pack("<I", len(body)) + body
    return message + bytes(-len(message) % 4)


def _ends(
    rig: Rig, source: str, target: str, written: str = STRING, read: str = STRING
) -> tuple[Publisher, Subscription]:
    publisher = rig.participant(source).publisher("/t", written, DEEP)
    subscription = rig.participant(target).subscription("/t", read, DEEP)
    rig.match(publisher, subscription)
    return publisher, subscription


def test_a_type_without_code(rig: Rig) -> None:
    rig.bridge(_entry("A", "B"))
    publisher, subscription = _ends(rig, "A", "B")
    sent = [_text("x" * length) for length in (0, 1, 2, 3, 50, 5000)]
    assert all(publisher.write(sample) for sample in sent)
    assert rig.receive(subscription, len(sent)) == sent


def test_peers_that_know_the_type(rig: Rig) -> None:
    """Programs with a type of their own, and its type information, match an opaque route."""
    rig.bridge(_entry("A", "B"))
    _exchange(rig)
    gc.collect()  # deletes their entities


def _exchange(rig: Rig) -> None:
    kind: Any = make_idl_struct("Text", "example_interfaces.msg.dds_.String_", {"data": str})
    here, there = DomainParticipant(rig.domains[0]), DomainParticipant(rig.domains[1])
    writer = DataWriter(here, Topic(here, "rt/t", kind))
    reader = DataReader(
        there, Topic(there, "rt/t", kind), CycloneQos(Policy.Reliability.Reliable(0))
    )
    rig.until(lambda: writer.get_matched_subscriptions() and reader.get_matched_publications())
    writer.write(kind(data="hello"))
    rig.until(lambda: len(reader.read()) == 1)
    assert [sample.data for sample in reader.take()] == ["hello"]


def test_compress_and_decompress(rig: Rig) -> None:
    """Through two bridges: whole, then compressed, then whole again."""
    packing = rig.bridge("mode: compress\n" + _entry("A", "B", STEERING))
    rig.bridge("mode: decompress\n" + _entry("B", "C", STEERING))
    publisher, subscription = _ends(rig, "A", "C", STEERING, STEERING)
    between = rig.participant("B").subscription("/t", COMPRESSED, DEEP)
    rig.match(between)
    sample = encode_steering(Steering(Time(1, 2), 0.25))
    assert publisher.write(sample)
    assert rig.receive(subscription) == [sample]
    assert rig.receive(between)[0][:4] == b"\x00\x01\x00\x00"
    assert packing.totals()["bytes"] > 0


def test_what_is_not_compressed_is_refused_and_counted(rig: Rig) -> None:
    bridge = rig.bridge("mode: decompress\n" + _entry("A", "B"))
    publisher, subscription = _ends(rig, "A", "B", COMPRESSED)
    for _ in range(3):
        assert publisher.write(_text("this is no zstd frame"))
    rig.until(lambda: bridge.totals()["refused"] == 3)
    assert subscription.take_all() == []
    assert sum("sample refused" in line for line in rig.said) == 1


def test_compressed_content_of_another_type_is_lost_and_counted(rig: Rig) -> None:
    """The island's own types are checked when they are written on."""
    packing = rig.bridge("mode: compress\n" + _entry("A", "B", STRING))
    unpacking = rig.bridge("mode: decompress\n" + _entry("B", "C", STEERING))
    publisher, _ = _ends(rig, "A", "C", STRING, STEERING)
    assert publisher.write(_text(""))
    rig.until(lambda: unpacking.totals()["failed"] == 1)
    assert packing.totals()["forwarded"] == 1
    assert "sample lost in domain" in rig.said[-1]
