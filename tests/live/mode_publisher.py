# SPDX-License-Identifier: Apache-2.0
"""A process that publishes the operation mode alone: each line of its input is a mode.

It leaves the domain in good order at the end of its input.
"""

from __future__ import annotations

import sys
import time

from safety_island.dds import topics
from safety_island.dds.config import DdsConfig
from safety_island.dds.participant import Participant
from safety_island.messages.inputs import OperationMode, encode_operation_mode
from safety_island.messages.wire import Time


def main() -> None:
    """Publish what is asked for."""
    entry = topics.OPERATION_MODE
    with Participant(int(sys.argv[1]), DdsConfig(interface="lo"), "mode") as participant:
        publisher = participant.publisher(entry.name, entry.type_name, entry.qos)
        for line in sys.stdin:
            mode = OperationMode(Time.from_nanoseconds(time.time_ns()), int(line), True)
            assert publisher.write(encode_operation_mode(mode))


if __name__ == "__main__":
    main()
