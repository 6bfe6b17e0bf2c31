"""Fixtures that several rooms share."""

from __future__ import annotations

import os
from collections.abc import Iterator
from itertools import count

import pytest

_counter = count(int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw")) * 60 + 20)


@pytest.fixture
def domain_id() -> Iterator[int]:
    """A DDS domain id (20 to 229) that no other test of this run uses at the same time."""
    yield 20 + (next(_counter) - 20) % 210
