# SPDX-License-Identifier: Apache-2.0
"""The three test programs as they are built: against each other, and a peer that is not ours."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from safety_island.cli.programs.samples import sample
from safety_island.dds import topics
from safety_island.messages import codec
from safety_island.messages.wire import Time
from safety_island.targets.package.products import DDS_PUBLISHER, DDS_SUBSCRIBER, UNIT_TEST, Product
from tests.targets.package import pyz_process

PEER = Path(__file__).with_name("typed_peer.py")
pytestmark = [pytest.mark.live, pytest.mark.timeout(600)]


@pytest.fixture(scope="session")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A home folder, in which the programs are unpacked."""
    return tmp_path_factory.mktemp("programs")


@pytest.fixture
def program(build_of: Callable[[str, Product], Path]) -> Callable[[Product], Path]:
    """Build a test program."""
    return lambda product: build_of("freertos_posix", product) / f"{product.file}.pyz"


@contextmanager
def peer(role: str, domain_id: int) -> Iterator[subprocess.Popen[str]]:
    """Run the peer, from when it is ready until the context ends."""
    command = [sys.executable, str(PEER), role, str(domain_id)]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as process:
        try:
            lines_until(process, "^ready$")
            yield process
        finally:
            process.kill()


def lines_until(process: subprocess.Popen[str], pattern: str) -> list[str]:
    """Read lines up to the first that matches."""
    assert process.stdout is not None
    found = []
    for line in process.stdout:
        found.append(line)
        if re.search(pattern, line):
            return found
    raise AssertionError(f"ended without {pattern!r}: {''.join(found)[-2000:]}")


def test_the_round_trip_program_passes(
    program: Callable[[Product], Path], home: Path, domain_id: int
) -> None:
    result = pyz_process.run(program(UNIT_TEST), home, "--domain", str(domain_id))
    assert result.returncode == 0, result.stdout + result.stderr[-2000:]
    assert result.stdout.endswith("all passed\n")
    assert result.stdout.count("ok ") == 2 + len(topics.TOPICS)


def test_the_subscriber_logs_what_the_publisher_sends(
    program: Callable[[Product], Path], home: Path, domain_id: int
) -> None:
    domain = ("--domain", str(domain_id))
    publisher, subscriber = program(DDS_PUBLISHER), program(DDS_SUBSCRIBER)
    with (
        pyz_process.started(subscriber, home, *domain) as listening,
        pyz_process.started(publisher, home, *domain) as sending,
    ):
        wanted = {entry.name for entry in topics.INPUTS}
        while wanted:
            wanted -= {line.split()[1].rstrip(":") for line in lines_until(listening, r"^\d+\.\d+")}
        text = lines_until(listening, "trajectory: ")[-1]
        assert "frame_id: map}, points: [101]}" in text
        for process in (listening, sending):
            process.send_signal(signal.SIGTERM)
        assert "in all" in lines_until(sending, "in all")[-1]
        assert "steering_status" in lines_until(listening, "in all")[-1]
        assert (listening.wait(), sending.wait()) == (0, 0)


def test_a_typed_peer_reads_what_the_publisher_sends(
    program: Callable[[Product], Path], home: Path, domain_id: int
) -> None:
    publisher = program(DDS_PUBLISHER)
    with (
        pyz_process.started(publisher, home, "--domain", str(domain_id)),
        peer("listen", domain_id) as listening,
    ):
        assert lines_until(listening, ".")[-1] == "0.0 map 101 5.0\n"


def test_the_subscriber_logs_what_a_typed_peer_sends(
    program: Callable[[Product], Path], home: Path, domain_id: int
) -> None:
    subscriber = program(DDS_SUBSCRIBER)
    with (
        peer("speak", domain_id),
        pyz_process.started(subscriber, home, "--domain", str(domain_id)) as listening,
    ):
        text = lines_until(listening, "control_cmd: ")[-1]
    assert "steering_tire_angle: 0.25, steering_tire_rotation_rate: -0.5" in text
    assert "velocity: 12.25, acceleration: -1.5" in text


def test_a_wrong_option_is_one_line(program: Callable[[Product], Path], home: Path) -> None:
    result = pyz_process.run(program(DDS_PUBLISHER), home, "--domain", "999")
    assert result.returncode == 2
    error = result.stderr.splitlines()[-1]
    assert error.startswith("dds-publisher: error: ") and "0 to 232" in error


@pytest.mark.parametrize("entry", topics.TOPICS, ids=lambda entry: str(entry.key))
def test_every_topic_has_a_sample(entry: topics.TopicEntry) -> None:
    message = codec.decode(entry.type_name, sample(entry, Time(3, 4), 25.0))
    if entry in topics.INPUTS:
        stamp = message.get("stamp") or message["header"]["stamp"]
        assert stamp == {"sec": 3, "nanosec": 4}
