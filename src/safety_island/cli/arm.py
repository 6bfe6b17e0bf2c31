# SPDX-License-Identifier: Apache-2.0
"""``island arm``: asks a SILENT island to send commands again."""

from __future__ import annotations

import argparse
import secrets
from typing import TYPE_CHECKING

from safety_island.cli import options
from safety_island.cli.parser import teach
from safety_island.errors import IslandError

if TYPE_CHECKING:
    from safety_island.cli.status.receive import StatusReader
    from safety_island.messages.status_fields import Status

NODE_NAME = "island_arm"
REPEAT_S = 0.2
"""Time between two sendings of one request."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    teach(
        parser,
        """
Ask a SILENT island to send commands again. It refuses as long as what made it SILENT stands, and
says so. Leaving autonomous mode and engaging it again does the same. The exit code is 0 when the
island is armed now, or was.
""",
        ("island arm", "the island on domain 2 of this machine"),
        ("island arm --interface eth0 --domain 3", "another one"),
    )
    options.add_domain(parser, 2, "the safety island")
    options.add_network(parser)
    options.add_timeout(parser, "the answer")


def execute(arguments: argparse.Namespace) -> int:
    """Ask, wait for the answer and print it; return the exit code."""
    from safety_island.cli.status.receive import StatusReader
    from safety_island.messages.arm import ArmResult
    from safety_island.status.why import why

    with StatusReader(arguments, NODE_NAME) as reader:
        status = _ask(reader, arguments.timeout)
    armed = status.arm_result in (ArmResult.ARMED, ArmResult.NOT_NEEDED)
    words = {ArmResult.ARMED: "armed", ArmResult.NOT_NEEDED: "not needed"}
    result = words[ArmResult(status.arm_result)] if armed else "refused"
    print(f"{result}: {why(status)}")
    return 0 if armed else 1


def _ask(reader: StatusReader, timeout_s: float) -> Status:
    """Send a request again and again until a status answers it. Raises IslandError when none does.

    Again, because what is sent while island and command still find each other may be lost.
    """
    from safety_island.dds.topics import ARM
    from safety_island.messages.arm import Arm, encode_arm
    from safety_island.messages.wire import Time

    publisher = reader.participant.publisher(ARM.name, ARM.type_name, ARM.qos)
    nonce = secrets.randbits(64) or 1
    data = encode_arm(Arm(Time.from_nanoseconds(reader.clock.wall_ns()), nonce))
    end = reader.now() + timeout_s
    while (left := end - reader.now()) > 0.0:
        if publisher.matched():
            publisher.write(data)
        answer = reader.find(lambda status: status.arm_nonce == nonce, min(left, REPEAT_S))
        if answer is not None:
            return answer
    raise _no_answer(reader, publisher.matched() > 0, timeout_s)


def _no_answer(reader: StatusReader, is_heard: bool, timeout_s: float) -> IslandError:
    from safety_island.dds.topics import ARM

    if not reader.came:
        return reader.nothing(timeout_s)
    if is_heard:
        return IslandError(
            f"the island does not answer: it got the request and sends its status, but none in"
            f" {timeout_s:g} s answers the request ({reader.where}); try again, with more --timeout"
        )
    return IslandError(
        f"the island does not answer: it sends its status, but nobody listens on {ARM.name}"
        f" ({reader.where}); use the version of the island here"
    )
