# SPDX-License-Identifier: Apache-2.0
"""Participants of ours with CycloneDDS 0.10 of the system, and with that of the wheel."""

from __future__ import annotations

from pathlib import Path

import pytest

from safety_island.dds import topics
from safety_island.dds.library.find import Machine, find
from safety_island.dds.library.loading import Library
from safety_island.dds.library.release import Release
from safety_island.errors import IslandError
from tests.dds.peer import line, module

RELEASES = {"0.10": Machine(packages=None, environment={}), "11": Machine(environment={})}
PAIRS = [("0.10", "0.10"), ("0.10", "11"), ("11", "0.10")]


def library(release: str) -> Path:
    """Return the library of a release; skip where this machine has none."""
    try:
        found = find(machine=RELEASES[release])
    except IslandError as missing:
        pytest.skip(str(missing))
    if Library(found).release != release:
        pytest.skip(f"{found} is not of CycloneDDS {release} (Debian: cyclonedds-dev)")
    return found


@pytest.mark.parametrize("release", RELEASES)
def test_the_release_is_read_from_the_library(release: str) -> None:
    assert Library(library(release)).release is Release(release)


@pytest.mark.live
@pytest.mark.parametrize(("asks", "answers"), PAIRS)
def test_every_topic_there_and_back(asks: str, answers: str, domain_id: int) -> None:
    domain = str(domain_id)
    with module("tests.dds.talk", "answer", domain, str(library(answers))) as other:
        assert [line(other), line(other)] == [answers, "ready"]
        with module("tests.dds.talk", "ask", domain, str(library(asks))) as own:
            assert line(own) == asks
            for entry in topics.TOPICS:
                assert line(own) == f"{entry.key} same /answer hash True"
            assert line(own) == "mismatches []"
            assert own.wait(30) == 0
