# SPDX-License-Identifier: Apache-2.0
"""Says a state and takes it back, again and again: ``python -m tests.interop.withdrawing_peer D``.

One after the other whenever odometry comes. Ends when its standard input closes.
"""

from __future__ import annotations

import select
import sys

from safety_island.dds import topics
from safety_island.dds.config import DdsConfig
from safety_island.dds.participant import Participant
from safety_island.dds.qos import LATCHED
from safety_island.messages import inputs
from safety_island.messages.wire import Time


def main(domain_id: int) -> None:
    """Say 1, take it back, say 2, and so on."""
    with Participant(domain_id, DdsConfig(loopback_only=True)) as own:
        entry = topics.ODOMETRY
        state = own.publisher("/echo/state", entry.type_name, LATCHED)
        odometry = own.subscription(entry.name, entry.type_name, entry.subscription_qos)
        said = 0
        while not select.select([sys.stdin], [], [], 0)[0]:
            own.wait(0.2)
            if odometry.take_newest() is None or not state.matched():
                continue
            said += 1
            message = inputs.Odometry(Time(), "map", "base_link", float(said), *[0.0] * 12)
            state.write(inputs.encode_odometry(message))
            state.withdraw()


if __name__ == "__main__":
    main(int(sys.argv[1]))
