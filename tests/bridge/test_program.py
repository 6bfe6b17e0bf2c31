# SPDX-License-Identifier: Apache-2.0
"""The bridge as a program: it starts, reports, survives kill -9 of another, and ends when told."""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from safety_island.bridge import BridgeOptions, run
from safety_island.dds.config import DdsConfig
from safety_island.dds.participant import Participant
from safety_island.dds.topics import ODOMETRY
from safety_island.errors import ConfigurationError
from safety_island.messages import codec
from tests.dds.waiting import wait_for

SHIPPED = Path(__file__).parents[2] / "demo" / "bridge" / "bridge-config.yaml"
LOOPBACK = DdsConfig(loopback_only=True)
SAMPLE = codec.encode(ODOMETRY.type_name, {})
PROGRAM = """
import sys, threading
from safety_island.bridge import BridgeOptions, run
from safety_island.platform.posix.process import on_stop
stop = threading.Event()
with on_stop(stop.set):
    sys.exit(run([sys.argv[1]], BridgeOptions(), stop))
"""


@contextmanager
def _process(path: Path) -> Iterator[subprocess.Popen[str]]:
    command = [sys.executable, "-c", PROGRAM, str(path)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        try:
            yield process
        finally:
            process.kill()


def _file(folder: Path, pair: tuple[int, int]) -> Path:
    """The shipped file between two domains of the test."""
    text = SHIPPED.read_text()
    for shipped, domain in zip("12", pair, strict=True):
        text = text.replace(f"_domain: {shipped}\n", f"_domain: {domain} \n")
    path = folder / "bridge.yaml"
    path.write_text(text)
    return path


def test_ends_within_a_second_and_reports(tmp_path: Path, domain_pair: tuple[int, int]) -> None:
    stop, events, said = threading.Event(), list[tuple[str, Mapping[str, Any]]](), list[str]()
    path = str(_file(tmp_path, domain_pair))
    arguments = ([path], BridgeOptions(), stop, lambda *event: events.append(event), said.append)
    thread = threading.Thread(target=run, args=arguments)
    thread.start()
    wait_for(lambda: [kind for kind, _ in events] == ["counts"])
    stop.set()
    told = time.monotonic()
    thread.join()
    assert time.monotonic() - told < 1.0
    assert [kind for kind, _ in events] == ["counts", "counts"] + ["route"] * 6
    assert events[0][1]["routes"] == 6
    assert {event["topic"] for kind, event in events if kind == "route"} >= {ODOMETRY.name}
    assert said[0].endswith("waiting for a publisher")
    assert said[-1] == "forwarded 0 samples, none lost"


def test_ends_after_its_duration(tmp_path: Path, domain_pair: tuple[int, int]) -> None:
    path = str(_file(tmp_path, domain_pair))
    options = BridgeOptions(duration_s=0.05)
    assert run([path], options, threading.Event(), say=lambda _: None) == 0


def test_a_mistake_is_told_before_anything_starts(tmp_path: Path) -> None:
    path = tmp_path / "bridge.yaml"
    path.write_text("topics: {a: {type: p/msg/T, from_domain: 1, to_domain: 1}}")
    with pytest.raises(ConfigurationError, match=r"bridge\.yaml:1: "):
        run([str(path)], BridgeOptions(), threading.Event())


def test_an_interface_that_is_not_there(tmp_path: Path, domain_pair: tuple[int, int]) -> None:
    options = BridgeOptions(dds=DdsConfig(interface="nowhere0"))
    with pytest.raises(ConfigurationError, match="nowhere0"):
        run([str(_file(tmp_path, domain_pair))], options, threading.Event(), say=lambda _: None)


@pytest.mark.live
def test_kill_and_restart(tmp_path: Path, domain_pair: tuple[int, int]) -> None:
    """A new bridge takes over from one that was killed; SIGTERM ends it with exit code 0."""
    path = _file(tmp_path, domain_pair)
    main, island = (Participant(domain, LOOPBACK) for domain in domain_pair)
    with main, island:
        publisher = main.publisher(ODOMETRY.name, ODOMETRY.type_name, ODOMETRY.qos)
        subscription = island.subscription(ODOMETRY.name, ODOMETRY.type_name, ODOMETRY.qos)

        def passes() -> bool:
            assert publisher.write(SAMPLE)
            return island.wait(0.05) and subscription.take_newest() is not None

        with _process(path) as first:
            wait_for(passes)
            first.kill()
            first.wait()
            wait_for(lambda: not publisher.matched() and not subscription.matched())
            subscription.take_all()
        with _process(path) as second:
            wait_for(passes)
            told = time.monotonic()
            second.terminate()
            assert second.wait(5.0) == 0
            assert time.monotonic() - told < 1.0
