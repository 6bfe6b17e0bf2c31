# SPDX-License-Identifier: Apache-2.0
"""Fixtures that several rooms share."""

from __future__ import annotations

import os
import random
from collections.abc import Iterator

import pytest
from hypothesis import settings

from safety_island.cli.domains import reserve

settings.register_profile("island", deadline=None)  # machines are slow at times; that is no fault
settings.load_profile("island")

FIRST, LAST = 20, 229
"""Domain ids that tests take; a person's own programs use lower ones."""


@pytest.fixture
def domain_id() -> Iterator[int]:
    """A DDS domain id that no other test, of this run or another, uses at the same time."""
    wanted = list(range(FIRST, LAST + 1))
    random.Random(os.getpid() * 1_000_003 + id(wanted)).shuffle(wanted)
    with reserve((domain,) for domain in wanted) as found:
        assert found is not None, f"every DDS domain id from {FIRST} to {LAST} is in use"
        yield found[0]


@pytest.fixture
def domain_pair(domain_id: int) -> Iterator[tuple[int, int]]:
    """Two DDS domain ids, for a bridge between them."""
    others = ((domain,) for domain in range(LAST, FIRST - 1, -1) if domain != domain_id)
    with reserve(others) as found:
        assert found is not None, f"every DDS domain id from {FIRST} to {LAST} is in use"
        yield domain_id, found[0]
