# SPDX-License-Identifier: Apache-2.0
"""Every test of the guard runs twice: with its rules as plain Python, and compiled."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import pytest

from safety_island.core import guard as compiled
from safety_island.guard import guard as rules
from safety_island.kernel import kernel

ENTRIES = ("guard_command", "guard_take_back", "guard_forget")


class PlainEntry:
    """An entry whose kernel runs as plain Python, whatever is compiled."""

    def __init__(self, function: Callable[..., int]) -> None:
        self.function = function

    def bind(self, *arrays: Any) -> Callable[..., int]:
        """Return the function with its records given."""
        return partial(self.function, *arrays)


@pytest.fixture(scope="module", params=["plain", "compiled"], autouse=True)
def form(request: pytest.FixtureRequest) -> Iterator[str]:
    """Which form of the rules a new Guard has."""
    with pytest.MonkeyPatch.context() as patch:
        if request.param == "plain":
            for name in ENTRIES:
                patch.setattr(compiled, name, PlainEntry(getattr(rules, name)))
        elif not kernel.JIT and kernel.LIBRARY is None:
            pytest.skip("kernels are plain Python in this process")
        yield request.param
