# SPDX-License-Identifier: Apache-2.0
"""A reader's room for one writer: what others write does not get in."""

from __future__ import annotations

import ctypes as ct
import mmap
import platform
from pathlib import Path

import pytest
from llvmlite import binding as llvm

from safety_island.dds import topics, writer_filter
from safety_island.dds.endpoints import Publisher, Subscription
from safety_island.dds.errors import DdsError
from safety_island.dds.library.layouts import SampleInfo
from safety_island.dds.qos import DEFAULT, LATCHED, Qos
from safety_island.dds.writer_filter import CODE, State, WriterFilter, function_address
from safety_island.messages import inputs
from safety_island.messages.wire import Time
from tests.dds.conftest import NewParticipant
from tests.dds.waiting import wait_for

TOPIC = (topics.STEERING.name, topics.STEERING.type_name)
SOURCE = Path(__file__).with_name("writer_filter.ll")
INSTRUCTIONS = {"x86_64": 24, "aarch64": 48}
"""Machine -> length of the code in bytes."""


def report(number: int) -> bytes:
    return inputs.encode_steering(inputs.Steering(Time(number, 0), 0.25))


@pytest.mark.parametrize("machine", CODE)
def test_the_code_is_what_llvm_makes_of_its_source(machine: str) -> None:
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    triple = f"{machine}-unknown-linux-gnu"
    module = llvm.parse_assembly(f'target triple = "{triple}"\n' + SOURCE.read_text())
    target = llvm.Target.from_triple(triple).create_target_machine(opt=2, reloc="pic")
    made = llvm.ObjectFileRef.from_data(target.emit_object(module))
    text = b"".join(section.data() for section in made.sections() if section.is_text())
    assert text == bytes.fromhex(CODE[machine])
    assert len(text) == INSTRUCTIONS[machine]


def test_it_keeps_one_writer_and_counts_the_rest() -> None:
    address = function_address()
    assert address is not None
    keeps = ct.CFUNCTYPE(ct.c_bool, ct.c_void_p, ct.c_void_p)(address)
    info, state = SampleInfo(), State()
    info.publication_handle = 2**63 + 5

    def asked(writer: int) -> bool:
        state.writer = writer
        return bool(keeps(ct.addressof(info), ct.addressof(state)))

    assert asked(0) and asked(2**63 + 5)
    assert state.kept_out == 0
    assert not asked(5) and not asked(2**63 + 4) and not asked(1)
    assert state.kept_out == 3


def test_where_the_machine_is_unknown_nothing_is_kept_out(
    participant: NewParticipant, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(platform, "machine", lambda: "abacus")
    assert writer_filter._memory.__wrapped__() is None
    monkeypatch.setattr(writer_filter, "function_address", lambda: None)
    first, second, reader = three(participant)
    first.write(report(1))
    sample = wait_for(reader.take_newest)
    assert reader.keep_to(sample.writer_guid)
    second.write(report(2))
    assert wait_for(reader.take_newest).writer_guid == second.guid


def test_where_the_system_forbids_it_as_well(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise PermissionError

    monkeypatch.setattr(mmap, "mmap", refuse)
    assert writer_filter._memory.__wrapped__() is None


def test_what_is_no_topic_cannot_be_filtered() -> None:
    with pytest.raises(DdsError, match="cannot be kept apart"):
        WriterFilter(1)


def three(
    participant: NewParticipant, qos: Qos = DEFAULT
) -> tuple[Publisher, Publisher, Subscription]:
    """Two writers, each of a participant of its own, and a reader of 64 samples."""
    writers = [participant().publisher(*TOPIC, qos) for _ in range(2)]
    reader = participant().subscription(*TOPIC, qos.with_depth(64))
    for writer in writers:
        wait_for(writer.matched)
    wait_for(lambda: reader.matched() == 2)
    return writers[0], writers[1], reader


def test_a_flood_of_another_writer_leaves_the_room(participant: NewParticipant) -> None:
    own, other, reader = three(participant)
    assert reader.keep_to(own.guid) is False  # it has said nothing yet
    own.write(report(1))
    wait_for(reader.take_newest)
    assert reader.keep_to(own.guid)
    own.write(report(2))
    for number in range(3, 1003):
        other.write(report(number))
    wait_for(lambda: reader.kept_out == 1000)
    assert [sample.data for sample in reader.take_all()] == [report(2)]
    assert reader.keep_to(b"")
    other.write(report(1003))
    assert wait_for(reader.take_newest).data == report(1003)


def test_other_subscriptions_of_the_topic_are_not_filtered(participant: NewParticipant) -> None:
    writers = [participant().publisher(*TOPIC, DEFAULT) for _ in range(2)]
    both = participant()
    filtered, free = (both.subscription(*TOPIC, DEFAULT.with_depth(64)) for _ in range(2))
    wait_for(lambda: [writer.matched() for writer in writers] == [2, 2])
    writers[0].write(report(1))
    wait_for(filtered.take_newest)
    wait_for(free.take_newest)
    assert filtered.keep_to(writers[0].guid)
    writers[1].write(report(2))
    assert wait_for(free.take_newest).data == report(2)
    assert filtered.take_newest() is None


def test_a_writer_that_has_gone_is_kept_to_no_longer(participant: NewParticipant) -> None:
    own, other, reader = three(participant)
    own.write(report(1))
    wait_for(reader.take_newest)
    own.close()
    wait_for(lambda: reader.matched() == 1)
    assert not reader.keep_to(own.guid)
    other.write(report(2))
    assert wait_for(reader.take_newest).data == report(2)


def test_what_was_kept_out_is_received_again_when_it_is_latched(
    participant: NewParticipant,
) -> None:
    own, other, reader = three(participant, LATCHED)
    own.write(report(1))
    wait_for(reader.take_newest)
    assert reader.keep_to(own.guid)
    other.write(report(2))
    wait_for(lambda: reader.kept_out)
    own.close()
    wait_for(lambda: reader.matched() == 1)
    assert reader.keep_to(b"")
    guid = reader.guid
    reader.renew()
    assert wait_for(reader.take_newest).data == report(2)
    assert reader.guid != guid
    other.write(report(3))
    assert wait_for(reader.take_newest).data == report(3)


def test_a_participant_waits_for_a_renewed_subscription(participant: NewParticipant) -> None:
    own = participant()
    reader = own.subscription(*TOPIC, LATCHED)
    reader.renew()
    assert not own.wait(0.0)
    participant().publisher(*TOPIC, LATCHED).write(report(1))
    assert own.wait(10.0)
    assert reader.take_newest() is not None
    reader.close()
    assert not own.wait(0.0)
