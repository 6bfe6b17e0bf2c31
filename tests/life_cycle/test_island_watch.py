# SPDX-License-Identifier: Apache-2.0
"""Which of two islands was there first."""

from __future__ import annotations

from safety_island.life_cycle.life_cycle import IslandWatch
from safety_island.life_cycle.limits import MAX_PUBLISHERS
from safety_island.life_cycle.reason import Reason

A, B, C = b"a" * 16, b"b" * 16, b"c" * 16
NOBODY: frozenset[bytes] = frozenset()


def watch() -> IslandWatch:
    """Joined at 10 s, looks around until 11 s."""
    return IslandWatch(10.0, 1.0)


def test_it_looks_around_for_its_time() -> None:
    island = watch()
    assert island.looks_around(10.0) and island.looks_around(10.999)
    assert not island.looks_around(11.0)


def test_alone_it_is_no_newcomer() -> None:
    island = watch()
    assert not island.is_newcomer
    island.update(NOBODY, 10.5)
    assert not island.is_newcomer and island.others == NOBODY


def test_who_finds_another_while_looking_around_is_the_newcomer() -> None:
    island = watch()
    island.update(NOBODY, 10.5)
    island.update(frozenset({A}), 11.0)
    assert island.is_newcomer and island.others == {A}


def test_who_comes_later_is_the_newcomer_himself() -> None:
    island = watch()
    island.update(NOBODY, 11.0)
    island.update(frozenset({A}), 11.001)
    assert not island.is_newcomer and island.others == {A}


def test_the_newcomer_waits_for_the_earlier_one_alone() -> None:
    island = watch()
    island.update(frozenset({A}), 10.5)
    island.update(frozenset({A, B}), 12.0)
    assert island.is_newcomer
    island.update(frozenset({B}), 13.0)
    assert not island.is_newcomer
    island.update(frozenset({A, B}), 14.0)
    assert not island.is_newcomer  # it has gone and come back: now it is the later one


def test_one_that_went_while_we_looked_around_does_not_count() -> None:
    island = watch()
    island.update(frozenset({A}), 10.25)
    island.update(NOBODY, 10.5)
    island.update(frozenset({A}), 12.0)
    assert not island.is_newcomer


def test_a_first_look_that_comes_late_still_finds_who_was_there() -> None:
    island = watch()
    island.update(frozenset({A}), 11.5)
    assert island.is_newcomer


MANY = frozenset(bytes([i] * 16) for i in range(MAX_PUBLISHERS))
ONE_MORE = MANY | {A}


def test_as_many_as_the_memory_holds_are_told_apart() -> None:
    island = watch()
    island.update(NOBODY, 10.5)
    island.update(MANY, 12.0)
    assert island.others == MANY and island.count == MAX_PUBLISHERS and not island.is_newcomer


def test_of_more_than_it_holds_one_may_have_been_there_first_until_all_have_gone() -> None:
    island = watch()
    island.update(NOBODY, 10.5)
    island.update(ONE_MORE, 12.0)
    assert island.is_newcomer and island.count == MAX_PUBLISHERS + 1
    assert island.others < ONE_MORE and len(island.others) == MAX_PUBLISHERS
    island.update(frozenset({B}), 13.0)
    assert island.is_newcomer and island.others == {B}
    island.update(NOBODY, 14.0)
    assert not island.is_newcomer
    island.update(frozenset({B}), 15.0)
    assert not island.is_newcomer


def test_a_first_look_counts_alone_also_when_there_were_too_many_before() -> None:
    island = watch()
    island.update(ONE_MORE, 10.25)
    assert island.is_newcomer
    island.update(NOBODY, 10.5)
    island.update(frozenset({A}), 12.0)
    assert not island.is_newcomer


def test_guids_that_differ_in_either_half_are_two() -> None:
    for other in (b"a" * 8 + b"b" * 8, b"b" * 8 + b"a" * 8):
        island = watch()
        island.update(frozenset({A}), 10.5)
        island.update(frozenset({other}), 12.0)
        assert not island.is_newcomer


def test_the_earlier_ones_that_are_left_count_whichever_they_are() -> None:
    for gone in (A, B, C):
        island = watch()
        island.update(frozenset({A, B, C}), 10.5)
        island.update(frozenset({A, B, C}) - {gone}, 12.0)
        assert island.is_newcomer
        island.update(frozenset({gone}), 13.0)
        assert not island.is_newcomer


class TestBlocked:
    def test_alone_nothing_is(self) -> None:
        assert watch().blocked(False, False, 11.0) is Reason.NONE

    def test_it_waits_for_discovery(self) -> None:
        island = watch()
        assert island.blocked(True, False, 10.999) is Reason.DISCOVERING
        island.update(frozenset({A}), 10.5)
        assert island.blocked(True, False, 10.6) is Reason.SECOND_ISLAND

    def test_publishers_that_come_and_go(self) -> None:
        island = watch()
        island.update(NOBODY, 10.5)
        island.update(frozenset({A}), 12.0)
        for keeps_first in (False, True):
            assert island.blocked(True, keeps_first, 12.0) is Reason.WRITER_FLAPPING

    def test_a_second_publisher_unless_the_first_is_kept(self) -> None:
        island = watch()
        island.update(NOBODY, 10.5)
        island.update(frozenset({A}), 12.0)
        assert island.blocked(False, False, 12.0) is Reason.SECOND_PUBLISHER
        assert island.blocked(False, True, 12.0) is Reason.NONE
