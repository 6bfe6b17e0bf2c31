# SPDX-License-Identifier: Apache-2.0
"""Machines in miniature: network namespaces that are joined by cables."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack

import pytest

from tests.interop.namespace import Namespace, reason_against

Machine = Callable[[], Namespace]


@pytest.fixture
def machine() -> Iterator[Machine]:
    """Make machines that can be joined; all end with the test."""
    if reason := reason_against():
        pytest.skip(reason)
    made: list[Namespace] = []
    with ExitStack() as stack:

        def make() -> Namespace:
            made.append(Namespace(beside=made[0] if made else None))
            stack.callback(made[-1].close)
            return made[-1]

        yield make
