# SPDX-License-Identifier: Apache-2.0
"""The island's side of the interop tests: ``python -m tests.interop.island_peer DOMAIN``.

Receives odometry and acceleration, changes one number, and sends them back on ``/echo/...``. Also
publishes one latched state before anybody listens. Ends when its standard input closes.
"""

from __future__ import annotations

import json
import select
import sys

from safety_island.dds import topics
from safety_island.dds.config import DdsConfig
from safety_island.dds.participant import Participant
from safety_island.dds.qos import LATCHED
from safety_island.messages import inputs
from safety_island.messages.wire import Time

STATE = inputs.Odometry(Time(), "map", "base_link", 42.0, *[0.0] * 12)


def main(domain_id: int) -> None:
    """Echo until standard input closes."""
    with Participant(domain_id, DdsConfig(loopback_only=True)) as own:
        state = own.publisher("/echo/state", topics.ODOMETRY.type_name, LATCHED)
        state.write(inputs.encode_odometry(STATE))
        odometry_in, acceleration_in = (
            own.subscription(entry.name, entry.type_name, entry.subscription_qos)
            for entry in (topics.ODOMETRY, topics.ACCELERATION)
        )
        odometry_out = own.publisher("/echo/odometry", topics.ODOMETRY.type_name)
        acceleration_out = own.publisher("/echo/acceleration", topics.ACCELERATION.type_name)
        while not select.select([sys.stdin], [], [], 0)[0]:
            own.wait(0.2)
            if sample := odometry_in.take_newest():
                found = inputs.decode_odometry(sample.data)
                print(json.dumps({"event": "odometry", "x": found.x, "wz": found.wz}), flush=True)
                covariance = (*[0.0] * 35, 0.75)
                odometry_out.write(inputs.encode_odometry(found._replace(x=-found.x), covariance))
            if sample := acceleration_in.take_newest():
                measured = inputs.decode_acceleration(sample.data)
                back = measured._replace(ax=-measured.ax)
                acceleration_out.write(inputs.encode_acceleration(back))


if __name__ == "__main__":
    main(int(sys.argv[1]))
