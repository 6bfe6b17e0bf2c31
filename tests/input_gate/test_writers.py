# SPDX-License-Identifier: Apache-2.0
"""To which publisher the island keeps, and how often they change."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from safety_island.input_gate.writers import MOST_OTHERS, UNKNOWN, WINDOW_S, Writers

A, B, C = b"a" * 16, b"b" * 16, b"c" * 16
NOBODY: frozenset[bytes] = frozenset()


def known(*guids: bytes, limit: int = 3) -> Writers:
    writers = Writers(limit)
    writers.update(frozenset(guids), 0.0)
    return writers


class TestOwner:
    def test_the_first_whose_sample_comes_is_kept(self) -> None:
        writers = known(A, B)
        assert writers.owner == b"" and writers.others == 1
        assert writers.takes(B) and writers.owner == B
        assert writers.takes(B) and not writers.takes(A)

    def test_one_that_has_gone_makes_room(self) -> None:
        writers = known(A, B)
        assert writers.takes(A)
        writers.update(frozenset({B}), 1.0)
        assert writers.owner == b"" and writers.others == 0
        assert writers.takes(B) and writers.owner == B and not writers.takes(A)

    def test_one_that_stays_is_kept(self) -> None:
        writers = known(A)
        assert writers.takes(A)
        writers.update(frozenset({A, B, C}), 1.0)
        assert writers.owner == A and writers.others == 2

    def test_more_are_not_counted_than_the_status_can_say(self) -> None:
        assert MOST_OTHERS == 255
        for count, others in ((255, 254), (256, 255), (257, 255)):
            assert known(*(n.to_bytes(16, "big") for n in range(count))).others == others

    def test_nobody(self) -> None:
        writers = known()
        assert (writers.owner, writers.others, writers.alive) == (b"", 0, NOBODY)

    def test_a_publisher_that_was_gone_at_once_is_taken_and_owns_nothing(self) -> None:
        writers = known(A)
        assert bytes(16) == UNKNOWN
        assert writers.takes(UNKNOWN) and writers.owner == b""
        assert writers.takes(A) and writers.owner == A

    def test_it_is_not_taken_while_an_owner_lives(self) -> None:
        writers = known(A)
        assert writers.takes(A) and not writers.takes(UNKNOWN)
        writers.update(NOBODY, 1.0)
        assert writers.takes(UNKNOWN) and writers.owner == b""

    def test_a_late_sample_of_one_that_has_gone_shuts_nobody_out(self) -> None:
        writers = known(A)
        writers.takes(A)
        writers.update(frozenset({B}), 1.0)
        assert writers.takes(A)
        assert writers.takes(B) and writers.owner == B


class TestChanges:
    def test_the_first_publishers_are_no_change_but_those_beside_them(self) -> None:
        assert not known(A).changed(0.0)
        assert known(A, B).changed(0.0)
        writers = known()
        writers.update(frozenset({A}), 1.0)
        assert not writers.changed(1.0)

    def test_a_change_is_told_for_a_second(self) -> None:
        writers = known(A)
        writers.update(frozenset({A, B}), 5.0)
        assert writers.changed(5.0) and writers.changed(5.0 + WINDOW_S)
        assert not writers.changed(6.001)

    def test_a_publisher_that_goes_is_no_change_until_the_next_comes(self) -> None:
        writers = known(A)
        writers.update(NOBODY, 1.0)
        assert not writers.changed(1.0)
        writers.update(frozenset({A}), 2.0)
        assert writers.changed(2.0)

    def test_three_within_a_second_are_flapping(self) -> None:
        assert WINDOW_S == 1.0
        writers = known(A)
        for now, guid in ((1.0, B), (1.5, A)):
            writers.update(frozenset({guid}), now)
            assert not writers.flaps(now)
        writers.update(frozenset({B}), 2.0)
        assert writers.flaps(2.0)
        assert not writers.flaps(2.001)

    def test_three_in_more_than_a_second_are_not(self) -> None:
        writers = known(A)
        for now, guid in ((1.0, B), (1.5, A), (2.001, B)):
            writers.update(frozenset({guid}), now)
        assert not writers.flaps(2.001)

    def test_several_at_once_count_each(self) -> None:
        writers = known(A)
        writers.update(frozenset({A, B, C}), 1.0)
        assert not writers.flaps(1.0)
        writers.update(frozenset({A, B, C, UNKNOWN}), 1.5)
        assert writers.flaps(1.5)


guids = st.sampled_from([A, B, C])
events = st.lists(st.frozensets(guids) | guids, max_size=30)


@given(events)
def test_one_alone_is_taken_as_long_as_it_lives(events: list[frozenset[bytes] | bytes]) -> None:
    writers, owner = Writers(3), b""
    for now, event in enumerate(events):
        if isinstance(event, frozenset):
            writers.update(event, float(now))
            owner = owner if owner in event else b""
        else:
            expected = event == owner or owner not in writers.alive
            assert writers.takes(event) is expected
            owner = event if expected else owner
        assert writers.owner == owner
