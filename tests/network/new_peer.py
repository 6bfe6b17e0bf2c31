# SPDX-License-Identifier: Apache-2.0
"""A program with the public Python package of CycloneDDS: does what ``old_peer.c`` does."""

from __future__ import annotations

import select
import sys

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication
from cyclonedds.core import InstanceState
from cyclonedds.domain import DomainParticipant

MOST = 256


def main(domain_id: int, topic: str) -> None:
    """Print the number of publishers whenever it changes."""
    participant = DomainParticipant(domain_id)
    reader = BuiltinDataReader(participant, BuiltinTopicDcpsPublication)
    before = -1
    while not select.select([sys.stdin], [], [], 0.02)[0]:
        found = reader.read(MOST)
        now = sum(
            endpoint.topic_name == topic
            and endpoint.sample_info.instance_state == InstanceState.Alive
            for endpoint in found
        )
        if now != before:
            print(now, flush=True)
        before = now


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.argv[2])
