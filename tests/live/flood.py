# SPDX-License-Identifier: Apache-2.0
"""A publisher that floods a topic: python -m tests.live.flood DOMAIN TOPIC RATE [Hz]."""

from __future__ import annotations

import sys
import time

from safety_island.control.status import Mode
from safety_island.dds import topics
from safety_island.dds.config import DdsConfig
from safety_island.dds.participant import Participant
from safety_island.messages.inputs import (
    Odometry,
    OperationMode,
    encode_odometry,
    encode_operation_mode,
)
from safety_island.messages.wire import Time

BURST = 20
"""Messages that are written at once."""
LONGEST_S = 120.0
"""It outlives no run of the tests that was killed."""


def message(key: str) -> bytes:
    """Return a message that would be accepted: AUTONOMOUS, or odometry."""
    now = Time.from_nanoseconds(time.time_ns())
    if key == topics.OPERATION_MODE.key:
        return encode_operation_mode(OperationMode(now, Mode.AUTONOMOUS, True))
    values = dict.fromkeys(Odometry._fields[3:], 0.0) | {"vx": 3.0, "qw": 1.0}
    return encode_odometry(Odometry(now, "map", "base_link", **values))


def main(domain: int, key: str, rate_hz: float) -> None:
    """Write until the end."""
    entry = topics.topic(key)
    with Participant(domain, DdsConfig(interface="lo"), "flood") as participant:
        publisher = participant.publisher(entry.name, entry.type_name, entry.qos)
        begin, count = time.monotonic(), 0
        while time.monotonic() < begin + LONGEST_S:
            data = message(key)
            for _ in range(BURST):
                publisher.write(data)
            count += BURST
            time.sleep(max(begin + count / rate_hz - time.monotonic(), 0.0))


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.argv[2], float(sys.argv[3]))
