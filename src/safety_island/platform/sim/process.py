# SPDX-License-Identifier: Apache-2.0
"""A simulated process gets no signals; a simulation stops its node by calling it."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext


def on_stop(callback: Callable[[], None]) -> AbstractContextManager[None]:
    """Return a context that does nothing; SIGINT keeps its usual meaning."""
    return nullcontext()
