# SPDX-License-Identifier: Apache-2.0
"""One side of a network test: ``python -m tests.network.peer ROLE DOMAIN INTERFACE [ARGUMENT...]``.

``receive`` prints its UDP ports, then the angle of every steering report that it receives.
``publish ANGLE`` publishes one report when a subscription matches and prints the writer's GUID.
``come-and-go [TAG]`` has a publisher of odometry until it is told a line. All of these end when
their standard input closes. ``forge ANGLE GUID HOST PORT...`` sends one report in a writer's name,
as its second.
"""

from __future__ import annotations

import os
import select
import socket
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from safety_island.dds import topics
from safety_island.dds.config import DdsConfig
from safety_island.dds.participant import Participant
from safety_island.messages.inputs import Steering, decode_steering, encode_steering
from safety_island.messages.wire import Time
from tests.dds.rtps import Forger
from tests.dds.waiting import wait_for

ENTRY = topics.STEERING
ECHO = "/echo/odometry"


def data(number: int, angle: str) -> bytes:
    """Return a steering report in CDR."""
    return encode_steering(Steering(Time(number, 0), float(angle)))


def own_ports() -> list[int]:
    """Return the UDP ports that this process receives on, whatever the address."""
    found = []
    for descriptor in Path("/proc/self/fd").iterdir():
        with suppress(OSError), socket.socket(fileno=os.dup(int(descriptor.name))) as opened:
            if opened.family == socket.AF_INET:
                found.append(opened.getsockname()[1])
    return found


def receive(domain_id: int, interface: str) -> None:
    """Print what is received."""
    os.dup2(1, 2)  # what is said of the interfaces as well
    with Participant(domain_id, DdsConfig(interface=interface)) as own:
        subscription = own.subscription(ENTRY.name, ENTRY.type_name, ENTRY.subscription_qos)
        print("ports", *own_ports(), flush=True)
        while not select.select([sys.stdin], [], [], 0)[0]:
            own.wait(0.1)
            for sample in subscription.take_all():
                print(f"{decode_steering(sample.data).steering_tire_angle:.1f}", flush=True)


def publish(domain_id: int, interface: str, angle: str) -> None:
    """Publish one sample, then stay."""
    with Participant(domain_id, DdsConfig(interface=interface), "owner") as own:
        publisher = own.publisher(ENTRY.name, ENTRY.type_name, ENTRY.qos)
        wait_for(publisher.matched, 30.0)
        publisher.write(data(1, angle))
        print(publisher.guid.hex(), flush=True)
        sys.stdin.read()


def come_and_go(domain_id: int, interface: str, tag: str = "") -> None:
    """Open a publisher, close it after a line of input, then stay."""
    with Participant(domain_id, DdsConfig(interface=interface, domain_tag=tag)) as own:
        publisher = own.publisher(ECHO, topics.ODOMETRY.type_name)
        print("open", flush=True)
        sys.stdin.readline()
        publisher.close()
        sys.stdin.read()


def forge(domain_id: int, _: str, angle: str, guid: str, host: str, *ports: str) -> None:
    """Send one sample in the name of another writer."""
    numbers = [int(port) for port in ports]
    forger = Forger(domain_id, bytes.fromhex(guid), 2, host, numbers)
    forger.send(data(2, angle))
    forger.close()
    print("sent", flush=True)


ROLES: dict[str, Callable[..., None]] = {
    "receive": receive,
    "publish": publish,
    "come-and-go": come_and_go,
    "forge": forge,
}

if __name__ == "__main__":
    ROLES[sys.argv[1]](int(sys.argv[2]), *sys.argv[3:])
