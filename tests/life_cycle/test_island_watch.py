# SPDX-License-Identifier: Apache-2.0
"""Which of two islands was there first."""

from __future__ import annotations

from safety_island.life_cycle.island_watch import IslandWatch

A, B = b"a" * 16, b"b" * 16
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
