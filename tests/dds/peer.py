# SPDX-License-Identifier: Apache-2.0
"""A peer in a process of its own: ``python -m tests.dds.peer ROLE DOMAIN [ARGUMENT]``.

It prints one line when it is ready and ends when its standard input closes.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from safety_island.dds import topics
from safety_island.dds.config import DdsConfig
from safety_island.dds.participant import Participant
from safety_island.dds.qos import Qos
from safety_island.messages import inputs
from safety_island.messages.wire import Time
from tests.dds.waiting import wait_for

ROOT = Path(__file__).parents[2]


@contextmanager
def peer(role: str, domain_id: int, *arguments: str) -> Iterator[subprocess.Popen[str]]:
    """Run a peer; the context ends it."""
    with module("tests.dds.peer", role, str(domain_id), *arguments) as process:
        yield process


@contextmanager
def module(name: str, *arguments: str) -> Iterator[subprocess.Popen[str]]:
    """Run a module of this repository; the context ends it."""
    command = [sys.executable, "-m", name, *arguments]
    environment = {"PYTHONPATH": f"{ROOT / 'src'}:{ROOT}", "PATH": ""}
    with subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        cwd=ROOT,
        env=environment,
    ) as process:
        try:
            yield process
        finally:
            process.kill()


def line(process: subprocess.Popen[str]) -> str:
    """Return the next line that the peer printed; fail when it ended instead."""
    assert process.stdout is not None
    found = process.stdout.readline()
    assert found, f"the peer ended with {process.poll()}"
    return found.strip()


def _publish(participant: Participant) -> None:
    """Publish one steering report when somebody listens, and tell the writer's GUID."""
    entry = topics.STEERING
    publisher = participant.publisher(entry.name, entry.type_name, entry.qos)
    wait_for(publisher.matched, 30.0)
    publisher.write(inputs.encode_steering(inputs.Steering(Time(1, 0), 0.5)))
    print(publisher.guid.hex(), flush=True)


def _hold(participant: Participant) -> None:
    """Subscribe to trajectories with a history that never drops, and read none of them."""
    entry = topics.TRAJECTORY
    participant.subscription(entry.name, entry.type_name, Qos(history="keep_all"))
    print("ready", flush=True)


def _echo(participant: Participant) -> None:
    """Send each steering report back on another topic."""
    entry = topics.STEERING
    back = participant.publisher("/back", entry.type_name, entry.qos)
    subscription = participant.subscription(entry.name, entry.type_name, entry.subscription_qos)
    print("ready", flush=True)
    while True:
        participant.wait(1.0)
        for sample in subscription.take_all():
            back.write(sample.data)


ROLES = {"publish": _publish, "hold": _hold, "echo": _echo}

if __name__ == "__main__":
    with Participant(int(sys.argv[2]), DdsConfig(loopback_only=True), "peer") as own:
        ROLES[sys.argv[1]](own)
        sys.stdin.read()
