# SPDX-License-Identifier: Apache-2.0
"""Tests on the machine at hand that the node works: timer, every topic over DDS, a whole tick."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from functools import partial

from safety_island.cli.programs import checks
from safety_island.cli.programs.frame import run
from safety_island.cli.progress import prepare_kernels
from safety_island.cli.stopping import StopFlag
from safety_island.dds import topics
from safety_island.dds.config import DdsConfig
from safety_island.dds.participant import Participant
from safety_island.platform import LogConfig, LogLevel, Platform, load

NAME = "unit-test"
PURPOSE = """
Test on this machine that the node works: its timer, a message of each topic over DDS and back, and
the way from five inputs to a control command. Exit code 0 when every test passes.
"""

Test = tuple[str, Callable[[], None]]


def test(arguments: argparse.Namespace, config: DdsConfig, stop: StopFlag) -> int:
    """Run every test; 1 when one fails."""
    platform = load("posix", LogConfig(LogLevel.NONE))
    prepare_kernels()
    failed = 0
    with (
        Participant(arguments.domain, config, "unit_test") as own,
        Participant(arguments.domain, config, "unit_test_peer") as peer,
    ):
        for name, body in _tests(platform, own, peer):
            if stop.is_set():
                return 1
            try:
                body()
                print(f"ok    {name}", flush=True)
            except checks.Failure as failure:
                failed += 1
                print(f"FAIL  {name}: {failure}", flush=True)
    print(f"{failed} failed" if failed else "all passed", flush=True)
    return 1 if failed else 0


def _tests(platform: Platform, own: Participant, peer: Participant) -> Iterator[Test]:
    yield f"node: {checks.TICKS} ticks on a grid", lambda: checks.ticks(platform, own)
    for entry in topics.TOPICS:
        yield f"dds: {entry.key}, {entry.type_name}", partial(checks.round_trip, own, peer, entry)
    yield (
        "node: five inputs give a control command",
        lambda: checks.command(platform, own, peer),
    )


def main() -> int:
    """Run the program; return its exit code."""
    return run(NAME, PURPOSE, test)
