# SPDX-License-Identifier: Apache-2.0
"""Policies as the library gets them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from cyclonedds.qos import Policy

from safety_island.dds.discovery import RemoteEndpoint
from safety_island.dds.mismatch import incompatible_policies, why_not
from safety_island.dds.names import dds_topic_name, ros_topic_name
from safety_island.dds.qos import (
    DEFAULT,
    INFINITE_NS,
    LATCHED,
    MAX_BLOCKING_NS,
    Qos,
    cyclone_qos,
    from_cyclone,
)

ALL = [
    DEFAULT,
    LATCHED,
    Qos("best_effort"),
    Qos(deadline_ns=5, lifespan_ns=6, liveliness="manual_by_topic", lease_ns=7),
]


def writer_qos(qos: Qos) -> Any:
    return cyclone_qos(qos, b"typehash=x;", writer=True)


def test_a_writer_blocks_at_most_30_ms() -> None:
    assert MAX_BLOCKING_NS <= 30_000_000
    assert writer_qos(DEFAULT)[Policy.Reliability].max_blocking_time == MAX_BLOCKING_NS


def test_a_writer_does_not_dispose_of_its_data() -> None:
    assert writer_qos(DEFAULT)[Policy.WriterDataLifecycle].autodispose is False


@pytest.mark.parametrize("writer", [True, False])
def test_plain_cdr_alone_is_offered_and_asked_for(writer: bool) -> None:
    found = cyclone_qos(DEFAULT, b"", writer=writer)[Policy.DataRepresentation]
    assert (found.use_cdrv0_representation, found.use_xcdrv2_representation) == (True, False)


def test_latched_writers_keep_as_many_as_their_depth() -> None:
    service = writer_qos(LATCHED.with_depth(3))[Policy.DurabilityService]
    assert service.history == Policy.History.KeepLast(3)
    assert writer_qos(DEFAULT)[Policy.DurabilityService] is None


@pytest.mark.parametrize("qos", ALL)
def test_policies_return_from_the_library_s_form(qos: Qos) -> None:
    assert from_cyclone(writer_qos(qos)) == qos


def test_user_data_carry_the_type_hash() -> None:
    assert bytes(writer_qos(DEFAULT)[Policy.Userdata].data) == b"typehash=x;"


def test_infinite_is_none() -> None:
    assert writer_qos(DEFAULT)[Policy.Deadline].deadline == INFINITE_NS
    assert from_cyclone(writer_qos(DEFAULT)).deadline_ns is None


@pytest.mark.parametrize("offered", ALL)
def test_every_writer_satisfies_a_reader_that_asks_for_the_same(offered: Qos) -> None:
    assert incompatible_policies(offered, offered) == []


def test_a_stronger_offer_is_no_mismatch() -> None:
    assert incompatible_policies(LATCHED, Qos("best_effort")) == []
    assert (
        incompatible_policies(replace(DEFAULT, deadline_ns=1), replace(DEFAULT, deadline_ns=2))
        == []
    )


def test_the_direction_of_a_mismatch_matters() -> None:
    remote = RemoteEndpoint(bytes(16), bytes(16), "/a", "p/msg/T", DEFAULT)
    assert why_not(remote, "p/msg/T", LATCHED, publisher=True) is not None
    assert why_not(remote, "p/msg/T", LATCHED, publisher=False) is None


def test_topic_names() -> None:
    assert dds_topic_name("/a/b_c") == "rt/a/b_c"
    assert ros_topic_name("rt/a/b_c") == "/a/b_c"
    assert ros_topic_name("ros_discovery_info") == "ros_discovery_info"
    assert ros_topic_name("rtx") == "rtx"
