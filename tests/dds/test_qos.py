# SPDX-License-Identifier: Apache-2.0
"""Policies that match, and names of topics."""

from __future__ import annotations

from dataclasses import replace

import pytest

from safety_island.dds.discovery import RemoteEndpoint
from safety_island.dds.mismatch import incompatible_policies, why_not
from safety_island.dds.names import dds_topic_name, ros_topic_name
from safety_island.dds.qos import DEFAULT, LATCHED, Qos

ALL = [
    DEFAULT,
    LATCHED,
    Qos("best_effort"),
    Qos(deadline_ns=5, lifespan_ns=6, liveliness="manual_by_topic", lease_ns=7),
]


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
