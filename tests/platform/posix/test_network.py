# SPDX-License-Identifier: Apache-2.0
"""An address that comes late, in a network namespace of the test's own."""

from __future__ import annotations

import os
import socket
import subprocess
import sys

import pytest

from safety_island.platform import load
from tests.platform.posix.namespace import ISOLATED, may_isolate

LATE = """
import subprocess, threading
from safety_island.platform import load

network = load("posix").network
assert network.address("lo") is None
assert network.describe("lo") == "it is down"
starter = threading.Timer(0.05, lambda: subprocess.run(["ip", "link", "set", "lo", "up"]))
starter.start()
assert network.wait_for_address("lo", limit_s=30.0) == "127.0.0.1"
starter.join()
subprocess.run(["ip", "address", "flush", "dev", "lo"], check=True)
assert network.describe("lo") == "it is up and has no IPv4 address"
print("as expected")
"""


@pytest.mark.skipif(not may_isolate(), reason="no network namespaces on this machine")
def test_the_wait_ends_as_soon_as_the_address_is_there() -> None:
    run = subprocess.run(
        [*ISOLATED, sys.executable, "-c", LATE],
        capture_output=True,
        text=True,
        timeout=60,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )
    assert (run.stdout, run.stderr) == ("as expected\n", "")


def test_without_netlink_it_still_finds_the_address(monkeypatch: pytest.MonkeyPatch) -> None:
    def forbidden(*_: object) -> socket.socket:
        raise PermissionError("no netlink here")

    answers = iter([None, None, "10.0.0.9"])
    network = load("posix").network
    monkeypatch.setattr("safety_island.platform.posix.network.socket.socket", forbidden)
    monkeypatch.setattr(network, "address", lambda name: next(answers))
    assert network.wait_for_address("lo", limit_s=10.0) == "10.0.0.9"
