# SPDX-License-Identifier: Apache-2.0
"""The fault campaign: seeded, on virtual time, and each failure says how to repeat it."""

from __future__ import annotations

import os
import shlex
import zlib
from collections.abc import Generator, Iterator
from contextlib import ExitStack
from random import Random

import pytest

from safety_island.dds.config import URI
from safety_island.dds.participant import Participant
from tests.dds.conftest import LOOPBACK, NewParticipant

SEED = "FAULTS_SEED"
"""Environment variable: another number draws other phases, losses and bits."""


def seed() -> int:
    """Return the number of this campaign; 0 unless somebody asks for another one."""
    return int(os.environ.get(SEED, "0"))


@pytest.fixture
def random(request: pytest.FixtureRequest) -> Random:
    """Random numbers that depend on the seed and the name of the test alone."""
    return Random(zlib.crc32(f"{seed()} {request.node.name}".encode()))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item,
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Let a failure show the one command that repeats it."""
    report = yield
    if report.failed:
        command = f"{SEED}={seed()} ./island test {shlex.quote(item.nodeid)}"
        report.sections.append(("repeat with", command))
    return report


@pytest.fixture
def participant(domain_id: int, monkeypatch: pytest.MonkeyPatch) -> Iterator[NewParticipant]:
    """Make participants on this test's domain, loopback only; they are closed at its end."""
    monkeypatch.delenv(URI, raising=False)
    with ExitStack() as stack:
        yield lambda name="safety_island", config=LOOPBACK: stack.enter_context(
            Participant(domain_id, config, name)
        )
