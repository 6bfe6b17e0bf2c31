# SPDX-License-Identifier: Apache-2.0
"""The bus over UDP between processes, in a network namespace of its own."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from tests.can.peers import NETNS, ROOT

LOOPBACK = "ip link set lo up && ip route add 224.0.0.0/4 dev lo"
INSIDE = ["unshare", "--map-root-user", "--net", "sh", "-c"]


def run_inside(*command: str) -> subprocess.CompletedProcess[str]:
    kept = {key: value for key, value in os.environ.items() if "PYTEST" not in key}
    return subprocess.run(
        [*INSIDE, f'{LOOPBACK} && exec "$@"', "sh", *command],
        capture_output=True,
        text=True,
        cwd=ROOT,
        env=kept | {NETNS: "1"},
        check=False,
    )


def test_the_contract_holds_between_two_processes() -> None:
    if run_inside("true").returncode:
        pytest.skip("this user may not make a network namespace (unshare --net)")
    found = run_inside(
        sys.executable,
        *("-m", "pytest", "-n", "0", "-q", "-p", "no:cacheprovider"),
        *("-k", "udp_multicast", "tests/can/test_contract.py"),
    )
    assert found.returncode == 0, found.stdout + found.stderr
    assert "passed" in found.stdout
    assert "skipped" not in found.stdout
