# SPDX-License-Identifier: Apache-2.0
"""Publishes sample messages of the five inputs in a loop, at the rates of the real ones."""

from __future__ import annotations

import argparse
import time

from safety_island.cli.programs.frame import run
from safety_island.cli.programs.samples import SPEED, sample
from safety_island.cli.stopping import StopFlag
from safety_island.dds import topics
from safety_island.dds.config import DdsConfig
from safety_island.dds.participant import Participant
from safety_island.messages.wire import Time

NAME = "dds-publisher"
PURPOSE = """
Publish sample messages of the island's five inputs in a loop: a vehicle that drives straight on.
The operation mode, which others send on change, is sent once a second.
"""
_ON_CHANGE_HZ = 1.0
_TELL_EVERY_S = 1.0


class Loop:
    """Sends each topic when it is due; times in seconds of a monotonic clock."""

    def __init__(self, participant: Participant, start: float) -> None:
        self._start = start
        self._publishers = {
            entry.key: participant.publisher(entry.name, entry.type_name, entry.qos)
            for entry in topics.INPUTS
        }
        self._due = dict.fromkeys(topics.INPUTS, start)

    def send_due(self, now: float, stamp: Time) -> float:
        """Send what is due; return when the next one is."""
        for entry, due in self._due.items():
            if due <= now:
                data = sample(entry, stamp, SPEED * (now - self._start))
                self._publishers[entry.key].write(data)
                self._due[entry] = max(due + 1.0 / (entry.rate_hz or _ON_CHANGE_HZ), now)
        return min(self._due.values())

    def counts(self) -> str:
        """Return how much was sent, in words."""
        return ", ".join(f"{key} {item.sent}" for key, item in self._publishers.items())


def publish(arguments: argparse.Namespace, config: DdsConfig, stop: StopFlag) -> int:
    """Publish until told to stop or the time is up."""
    with Participant(arguments.domain, config, "dds_publisher") as participant:
        start = time.monotonic()
        loop, told = Loop(participant, start), start
        print(f"publishing on domain {arguments.domain}", flush=True)
        while not stop.is_set():
            now = time.monotonic()
            if arguments.duration and now - start >= arguments.duration:
                break
            due = loop.send_due(now, Time.from_nanoseconds(time.time_ns()))
            if now - told >= _TELL_EVERY_S:
                told = now
                print(f"sent: {loop.counts()}", flush=True)
            time.sleep(max(due - time.monotonic(), 0.0))
        print(f"sent in all: {loop.counts()}", flush=True)
    return 0


def main() -> int:
    """Run the program; return its exit code."""
    return run(NAME, PURPOSE, publish)
