# SPDX-License-Identifier: Apache-2.0
"""A network namespace for one test: a function runs in it, in a process of its own."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ISOLATED = ("unshare", "--net", "--map-root-user", "--pid", "--fork", "--kill-child")
"""With process ids of its own, so that nothing outlives a test."""


def may_isolate() -> bool:
    """Whether this machine lets a test have a network namespace."""
    try:
        return subprocess.run([*ISOLATED, "true"], capture_output=True).returncode == 0
    except FileNotFoundError:
        return False


def call_isolated(module: str, function: str, *arguments: str) -> None:
    """Call a function of a test module with texts; what it raises fails the test."""
    code = f"import sys; from {module} import {function} as f; f(*sys.argv[1:])"
    done = subprocess.run(
        [*ISOLATED, sys.executable, "-W", "error", "-c", code, *arguments],
        capture_output=True,
        text=True,
        timeout=110,
        cwd=Path(__file__).parents[3],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )
    assert (done.returncode, done.stderr) == (0, ""), done.stdout + done.stderr


def ip(*words: str) -> str:
    """Run ``ip`` and return what it says."""
    return subprocess.run(["ip", *words], check=True, capture_output=True, text=True).stdout
