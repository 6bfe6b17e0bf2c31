# SPDX-License-Identifier: Apache-2.0
"""Starts self-contained programs as a second machine would: bare Python, nothing of this tree."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


def bare_python() -> str:
    """Return the Python below the virtual environment: without its packages."""
    base: str = sys._base_executable  # type: ignore[attr-defined]
    return str(Path(base).resolve())


def environment(home: Path) -> dict[str, str]:
    """Return what a program needs of its surroundings."""
    return {"PATH": os.defpath, "HOME": str(home), "SAFETY_ISLAND_CACHE": str(home / "cache")}


def command(archive: Path, *arguments: str) -> list[str]:
    """Return the command line; user packages of the machine are left out."""
    return [bare_python(), "-s", str(archive), *arguments]


def run(archive: Path, home: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run a program to its end."""
    return subprocess.run(
        command(archive, *arguments),
        env=environment(home),
        cwd=home,
        capture_output=True,
        text=True,
        check=False,
    )


@contextmanager
def started(archive: Path, home: Path, *arguments: str) -> Iterator[subprocess.Popen[str]]:
    """Run a program while the context lasts."""
    with subprocess.Popen(
        command(archive, *arguments),
        env=environment(home),
        cwd=home,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    ) as process:
        try:
            yield process
        finally:
            process.kill()
