# SPDX-License-Identifier: Apache-2.0
"""Waiting for events instead of sleeping."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TypeVar

T = TypeVar("T")


def wait_for(found: Callable[[], T | None], timeout_s: float = 10.0) -> T:
    """Return the first true value of ``found()``; fail when none comes in time."""
    end = time.monotonic() + timeout_s
    while time.monotonic() < end:
        value = found()
        if value:
            return value
        time.sleep(0.002)
    raise AssertionError(f"nothing came within {timeout_s} s")
