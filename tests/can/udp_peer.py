# SPDX-License-Identifier: Apache-2.0
"""A process at the other end of a ``udp_multicast`` bus.

Lines of the standard input are frames to send, lines of the standard output frames that came.
"""

from __future__ import annotations

import sys
import threading

import can

from safety_island.can.candump import format_frame
from safety_island.platform.interfaces import CanFrame


def main(channel: str) -> None:
    """Run until the standard input ends."""
    bus = can.Bus(interface="udp_multicast", channel=channel, ignore_config=True)
    sent: list[CanFrame] = []

    def listen() -> None:
        for message in bus:
            frame = CanFrame(message.arbitration_id, bytes(message.data))
            if frame in sent:
                sent.remove(frame)  # its own, which UDP brings back
            else:
                print(format_frame(frame), flush=True)

    threading.Thread(target=listen, daemon=True).start()
    print("ready", flush=True)
    for line in sys.stdin:
        identifier, data = line.strip().split("#")
        frame = CanFrame(int(identifier, 16), bytes.fromhex(data))
        sent.append(frame)
        bus.send(
            can.Message(arbitration_id=frame.arbitration_id, data=frame.data, is_extended_id=False)
        )


if __name__ == "__main__":
    main(sys.argv[1])
