# SPDX-License-Identifier: Apache-2.0
"""Hands on a running island: its timer, and functions that fail."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from tests.faults.scene import Row, Scene


def run(scene: Scene, seconds: float) -> list[Row]:
    """Let the node run on its timer; return the ticks."""
    begin = len(scene.rows)
    scene.node.run(scene.period_s, seconds)
    return scene.rows[begin:]


def fail_with(error: BaseException) -> Callable[..., Any]:
    """A function that raises."""

    def fail(*_: object, **__: object) -> Any:
        raise error

    return fail
