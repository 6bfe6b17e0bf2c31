# SPDX-License-Identifier: Apache-2.0
"""Work of other programs is told from the demo's own."""

from __future__ import annotations

import os

import pytest

from safety_island.cli.demo.machine_load import OtherWork, Usage, other_work, usage


def test_other_work_is_what_was_busy_but_not_ours(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "cpu_count", lambda: 2)
    found = other_work(Usage(100.0, 50.0, 1.0), Usage(120.0, 68.0, 5.0))
    assert found is not None
    assert found.cores == pytest.approx(1.4)
    assert found.of == 2
    assert found.is_much


def test_a_quiet_machine_is_not_busy() -> None:
    assert not OtherWork(0.3, 2).is_much
    assert OtherWork(0.5, 2).is_much


def test_what_the_machine_does_not_tell_is_not_claimed() -> None:
    assert other_work(None, Usage(1.0, 1.0, 0.0)) is None
    assert other_work(Usage(1.0, 1.0, 0.0), Usage(1.0, 1.0, 0.0)) is None


def test_the_usage_of_this_machine_is_read() -> None:
    found = usage()
    assert found is not None
    assert found.total >= found.busy > 0.0
    assert found.own > 0.0
