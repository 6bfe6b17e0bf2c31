# SPDX-License-Identifier: Apache-2.0
"""Commands with the C library that ``--ddsc`` names: the system's 0.10, the wheel's 11."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from safety_island.dds.library.find import VARIABLE
from tests.dds.library.test_releases import PAIRS, library

pytestmark = pytest.mark.live
_HIDDEN = {VARIABLE, "CYCLONEDDS_URI"}
ENVIRONMENT = {name: value for name, value in os.environ.items() if name not in _HIDDEN}


def command(*arguments: str) -> list[str]:
    return [sys.executable, "-m", "safety_island", *arguments]


def island(*arguments: str) -> subprocess.CompletedProcess[str]:
    """Run a command to its end."""
    return subprocess.run(
        command(*arguments), capture_output=True, text=True, timeout=100, env=ENVIRONMENT
    )


@contextmanager
def ended(run: list[str]) -> Iterator[None]:
    """Run a command in the background; the context ends it."""
    quiet = subprocess.DEVNULL
    with subprocess.Popen(run, stdout=quiet, stderr=quiet, env=ENVIRONMENT) as running:
        try:
            yield
        finally:
            running.kill()


@pytest.mark.parametrize(("asks", "answers"), PAIRS)
def test_an_island_tells_its_status(
    asks: str, answers: str, domain_id: int, compiled: None
) -> None:
    """An island of one release, a command of the other."""
    where = ("--domain", str(domain_id))
    run = command("run", *where, "--duration", "100", "--ddsc", str(library(answers)))
    with ended(run):
        seen = island("status", "--once", *where, "--timeout", "60", "--ddsc", str(library(asks)))
    assert (seen.returncode, seen.stderr) == (0, "")
    assert seen.stdout.startswith("INIT ") and "trajectory was never received" in seen.stdout


def test_a_library_that_is_none_is_one_line() -> None:
    failed = island("status", "--domain", "9", "--ddsc", "/etc")
    assert failed.returncode == 2
    assert failed.stderr == (
        "island: error: --ddsc /etc: expected libddsc.so, the C library of CycloneDDS, or its"
        " folder\n"
    )
