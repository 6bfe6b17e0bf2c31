# SPDX-License-Identifier: Apache-2.0
"""``demo/peer.py``: a program with the public CycloneDDS package alone drives with the island."""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.interop.namespace import Namespace, reason_against

pytestmark = pytest.mark.live
PEER = Path(__file__).parents[2] / "demo" / "peer.py"
COMMAND = re.compile(r"[+-]\d\.\d{4} rad, ([+-]\d+\.\d{3}) m/s2, at (\d+\.\d\d) m/s")


@pytest.fixture
def laptop() -> Iterator[Namespace]:
    """A machine with loopback alone."""
    if reason := reason_against():
        pytest.skip(reason)
    laptop = Namespace()
    yield laptop
    laptop.close()


def test_it_publishes_the_inputs_and_prints_the_commands_that_drive_it(
    compiled: None, laptop: Namespace
) -> None:
    laptop.start([sys.executable, "-m", "safety_island", "run", "--duration", "100"])
    peer = laptop.start([sys.executable, str(PEER), "2", "60"])

    def drives(line: str) -> float | None:
        found = COMMAND.fullmatch(line)
        assert found, line
        acceleration, speed = map(float, found.groups())
        return speed if acceleration > 0.0 and speed > 1.0 else None

    assert peer.expect(drives) > 1.0


def test_it_uses_the_public_package_and_nothing_of_ours() -> None:
    tree = ast.parse(PEER.read_text("utf-8"))
    names = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    names |= {a.name for node in ast.walk(tree) if isinstance(node, ast.Import) for a in node.names}
    assert {str(name).split(".")[0] for name in names} == {"cyclonedds", "sys", "time", "typing"}
    assert not any("._" in str(name) for name in names)
