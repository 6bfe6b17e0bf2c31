# SPDX-License-Identifier: Apache-2.0
"""Logs each message that it receives on the topics of the island."""

from __future__ import annotations

import argparse
import time
from collections.abc import Mapping
from typing import Any

import numpy as np

from safety_island.cli.programs.frame import run
from safety_island.cli.stopping import StopFlag
from safety_island.dds import topics
from safety_island.dds.config import DdsConfig
from safety_island.dds.endpoints import Subscription
from safety_island.dds.participant import Participant
from safety_island.dds.sample import Sample
from safety_island.messages import codec
from safety_island.messages.errors import DecodeError

NAME = "dds-subscriber"
PURPOSE = """
Log each message that comes in on the topics of the island, one line each: topic, the time at
which it was sent, content.
"""
_WAIT_S = 0.2


def subscribe(arguments: argparse.Namespace, config: DdsConfig, stop: StopFlag) -> int:
    """Log until told to stop or the time is up."""
    with Participant(arguments.domain, config, "dds_subscriber") as participant:
        subscriptions = [
            participant.subscription(entry.name, entry.type_name, entry.subscription_qos)
            for entry in topics.TOPICS
        ]
        end = time.monotonic() + arguments.duration if arguments.duration else float("inf")
        print(f"listening on domain {arguments.domain}", flush=True)
        while not stop.is_set() and time.monotonic() < end:
            participant.wait(_WAIT_S)
            for subscription in subscriptions:
                for sample in subscription.take_all():
                    print(line(subscription, sample), flush=True)
        counts = ", ".join(f"{item.topic} {item.received}" for item in subscriptions)
        print(f"received in all: {counts}", flush=True)
    return 0


def line(subscription: Subscription, sample: Sample) -> str:
    """Return one message as a line."""
    try:
        content = shown(codec.decode(subscription.type_name, sample.data))
    except DecodeError as error:
        content = f"cannot be decoded: {error}"
    sent_s = sample.source_timestamp_ns / 1e9
    return f"{sent_s:.6f} {subscription.topic}: {content}"


def shown(value: Any) -> str:
    """Return a value of a message in short: a list by its length."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{name}: {shown(item)}" for name, item in value.items()) + "}"
    if isinstance(value, (list, np.ndarray)):
        return f"[{len(value)}]"
    return f"{value:g}" if isinstance(value, float) else str(value)


def main() -> int:
    """Run the program; return its exit code."""
    return run(NAME, PURPOSE, subscribe)
