# SPDX-License-Identifier: Apache-2.0
"""Domain ids that somebody uses are seen, whichever way a participant was configured."""

from __future__ import annotations

import gc

import pytest
from cyclonedds.domain import Domain, DomainParticipant

from safety_island.cli.domains import in_use, pairs_from, reserve
from safety_island.cli.options import MAX_DOMAIN

UNICAST = "<General><Interfaces><NetworkInterface name='lo'/></Interfaces>{}</General>".format(
    "<AllowMulticast>false</AllowMulticast>"
)
MULTICAST = (
    "<General><Interfaces><NetworkInterface name='lo' multicast='true'/></Interfaces>"
    "<AllowMulticast>spdp</AllowMulticast></General>"
    "<Discovery><ParticipantIndex>none</ParticipantIndex></Discovery>"
)


@pytest.mark.parametrize("settings", [UNICAST, MULTICAST], ids=["unicast", "multicast"])
def test_participant_is_seen(domain_id: int, settings: str) -> None:
    assert not in_use(domain_id)
    domain = Domain(domain_id, f"<CycloneDDS><Domain>{settings}</Domain></CycloneDDS>")
    participant = DomainParticipant(domain_id)
    assert in_use(domain_id)
    del participant, domain
    gc.collect()
    assert not in_use(domain_id)


def test_second_reservation_gets_the_next_pair(domain_id: int) -> None:
    first = [(domain_id,), (231,)]
    with reserve([(232,), (231,)]) as one, reserve([(232,), (231,)]) as two:
        assert (one, two) == ((232,), (231,))
    with reserve(first) as found:
        assert found == (231,), "the fixture holds the other one"


def test_nothing_left_is_none() -> None:
    with reserve([(232,)]), reserve([(232,)]) as found:
        assert found is None


def test_reservation_ends_with_its_context() -> None:
    for _ in range(2):
        with reserve([(232,)]) as found:
            assert found == (232,)


def test_wanted_pair_comes_first_then_higher_ones() -> None:
    pairs = list(pairs_from(1, 2))
    assert pairs[:3] == [(1, 2), (3, 4), (5, 6)]
    assert max(max(pair) for pair in pairs) <= MAX_DOMAIN
