# SPDX-License-Identifier: Apache-2.0
"""Fixtures for DDS: loopback only, and no configuration from the machine around."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack

import pytest

from safety_island.dds.config import URI, DdsConfig
from safety_island.dds.participant import Participant

LOOPBACK = DdsConfig(loopback_only=True)
NewParticipant = Callable[..., Participant]


@pytest.fixture(autouse=True)
def _no_configuration_of_the_user(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(URI, raising=False)


@pytest.fixture
def participant(domain_id: int) -> Iterator[NewParticipant]:
    """Make participants on this test's domain; they are closed at its end."""
    with ExitStack() as stack:

        def make(node_name: str = "safety_island", config: DdsConfig = LOOPBACK) -> Participant:
            return stack.enter_context(Participant(domain_id, config, node_name))

        yield make
