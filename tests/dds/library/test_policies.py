# SPDX-License-Identifier: Apache-2.0
"""Policies as the library gets them, read back by the wheel's own Python layer."""

from __future__ import annotations

from typing import Any

import pytest
from cyclonedds.builtin_types import cqos_to_qos
from cyclonedds.qos import Policy

from safety_island.dds.library.policies import (
    endpoint_policies,
    policies,
    read_qos,
    read_user_data,
)
from safety_island.dds.qos import DEFAULT, INFINITE_NS, LATCHED, MAX_BLOCKING_NS, Qos

HASH = b"typehash=x;"
ALL = [
    DEFAULT,
    LATCHED,
    LATCHED.with_depth(7),
    Qos("best_effort"),
    Qos(durability="transient_local", history="keep_all"),
    Qos(deadline_ns=5, lifespan_ns=6, liveliness="manual_by_topic", lease_ns=7),
]


def as_others_read_it(
    qos: Qos, user_data: bytes = HASH, writer: bool = True, ignore_own: bool = False
) -> Any:
    convert: Any = cqos_to_qos
    with endpoint_policies(qos, user_data, writer=writer, ignore_own=ignore_own) as made:
        return convert(made)


def test_a_writer_blocks_at_most_30_ms() -> None:
    assert MAX_BLOCKING_NS <= 30_000_000
    assert as_others_read_it(DEFAULT)[Policy.Reliability].max_blocking_time == MAX_BLOCKING_NS


def test_a_writer_does_not_dispose_of_its_data() -> None:
    assert as_others_read_it(DEFAULT)[Policy.WriterDataLifecycle].autodispose is False


@pytest.mark.parametrize("writer", [True, False])
def test_plain_cdr_alone_is_offered_and_asked_for(writer: bool) -> None:
    found = as_others_read_it(DEFAULT, writer=writer)[Policy.DataRepresentation]
    assert (found.use_cdrv0_representation, found.use_xcdrv2_representation) == (True, False)


def test_latched_writers_keep_as_many_as_their_depth() -> None:
    service = as_others_read_it(LATCHED.with_depth(3))[Policy.DurabilityService]
    assert service.history == Policy.History.KeepLast(3)
    assert as_others_read_it(DEFAULT)[Policy.DurabilityService] is None


def test_a_reader_may_ignore_what_its_participant_writes() -> None:
    ignoring = as_others_read_it(DEFAULT, writer=False, ignore_own=True)
    assert ignoring[Policy.IgnoreLocal] == Policy.IgnoreLocal.Participant
    assert as_others_read_it(DEFAULT, writer=False)[Policy.IgnoreLocal] is None


@pytest.mark.parametrize("qos", ALL, ids=repr)
def test_others_read_what_was_asked_for(qos: Qos) -> None:
    found = as_others_read_it(qos)
    assert found[Policy.Reliability] == RELIABILITY[qos.reliability]
    latched = found[Policy.Durability] == Policy.Durability.TransientLocal
    assert latched == (qos.durability == "transient_local")
    keep_last = Policy.History.KeepLast(qos.depth)
    assert found[Policy.History] == (keep_last if qos.history == "keep_last" else KEEP_ALL)
    assert found[Policy.Deadline].deadline == (qos.deadline_ns or INFINITE_NS)
    assert found[Policy.Lifespan].lifespan == (qos.lifespan_ns or INFINITE_NS)
    assert found[Policy.Liveliness].lease_duration == (qos.lease_ns or INFINITE_NS)


KEEP_ALL = Policy.History.KeepAll
RELIABILITY = {
    "best_effort": Policy.Reliability.BestEffort,
    "reliable": Policy.Reliability.Reliable(MAX_BLOCKING_NS),
}


@pytest.mark.parametrize("qos", ALL, ids=repr)
def test_policies_return_from_the_library_s_form(qos: Qos) -> None:
    with endpoint_policies(qos, HASH, writer=True) as made:
        found = read_qos(made)
    assert found == (qos if qos.depth == 1 or qos.durability != "volatile" else DEFAULT)


@pytest.mark.parametrize("data", [b"", HASH, b"a\0b\xff"])
def test_user_data_return_as_they_were(data: bytes) -> None:
    with policies(data) as made:
        assert read_user_data(made) == data
    assert bytes(getattr(as_others_read_it(DEFAULT, data)[Policy.Userdata], "data", b"")) == data


def test_what_was_never_set_reads_as_the_weakest() -> None:
    with policies(b"") as made:
        assert read_qos(made) == Qos("best_effort")
