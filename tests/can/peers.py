# SPDX-License-Identifier: Apache-2.0
"""For each backend that this machine can open: a bus, and somebody at its other end."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Protocol

import can
import pytest

from safety_island.can.bus import BusLink
from safety_island.can.candump import format_frame
from safety_island.can.link import DirectLink
from safety_island.can.mock import MockBus
from safety_island.can.spec import BusSpec
from safety_island.platform.interfaces import CanFrame
from tests.can.fake_socketcan import fake_socketcan
from tests.can.slcan_adapter import SlcanAdapter

NETNS = "SAFETY_ISLAND_TEST_NETNS"
"""Set in a network namespace whose loopback carries multicast."""
GROUP = "239.74.163.2"
ROOT = Path(__file__).parents[2]


class Peer(Protocol):
    """The other end of a bus."""

    spec: BusSpec

    def heard(self) -> list[CanFrame]:
        """Frames that came so far."""

    def emit(self, frame: CanFrame) -> None:
        """Send a frame."""

    def join(self, link: BusLink) -> None:
        """Learn of the island's end, where that is needed."""

    def close(self) -> None:
        """Leave."""


class FarPeer:
    """A peer that needs to know nothing of the island's end."""

    def join(self, link: BusLink) -> None:
        pass


class MockPeer:
    """The mock's own record; it has no other node."""

    spec = BusSpec("mock")

    def __init__(self) -> None:
        self._bus = MockBus()

    def join(self, link: BusLink) -> None:
        assert isinstance(link, DirectLink)
        assert isinstance(link.device, MockBus)
        self._bus = link.device

    def heard(self) -> list[CanFrame]:
        return list(self._bus.frames)

    def emit(self, frame: CanFrame) -> None:
        raise AssertionError("the mock bus has no other node")

    def close(self) -> None:
        pass


class VirtualPeer(FarPeer):
    """Another node on python-can's bus inside this process."""

    spec = BusSpec("virtual", "contract")

    def __init__(self) -> None:
        self._bus = can.Bus(interface="virtual", channel="contract", ignore_config=True)
        self._frames: list[CanFrame] = []

    def heard(self) -> list[CanFrame]:
        while message := self._bus.recv(timeout=0):
            self._frames.append(CanFrame(message.arbitration_id, bytes(message.data)))
        return self._frames

    def emit(self, frame: CanFrame) -> None:
        self._bus.send(
            can.Message(arbitration_id=frame.arbitration_id, data=frame.data, is_extended_id=False)
        )

    def close(self) -> None:
        self._bus.shutdown()


class SlcanPeer(FarPeer):
    """An adapter on a pseudo-terminal."""

    def __init__(self) -> None:
        self.adapter = SlcanAdapter()
        self.spec = BusSpec("slcan", self.adapter.path, {"sleep_after_open": 0.0})

    def heard(self) -> list[CanFrame]:
        return list(self.adapter.frames)

    def emit(self, frame: CanFrame) -> None:
        self.adapter.emit(frame)

    def close(self) -> None:
        self.adapter.close()


class SocketCanPeer(FarPeer):
    """The kernel behind a fake SocketCAN interface."""

    spec = BusSpec("socketcan", "can0")

    def __init__(self, patch: pytest.MonkeyPatch) -> None:
        self._context = fake_socketcan(patch)
        self.kernel = self._context.__enter__()

    def heard(self) -> list[CanFrame]:
        self.kernel.run()
        return list(self.kernel.frames)

    def emit(self, frame: CanFrame) -> None:
        self.kernel.emit(frame.arbitration_id, frame.data)

    def close(self) -> None:
        self._context.__exit__(None, None, None)


class UdpPeer(FarPeer):
    """Another process on a bus over UDP."""

    spec = BusSpec("udp_multicast", GROUP)

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "tests.can.udp_peer", GROUP],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            cwd=ROOT,
            env=os.environ | {"PYTHONPATH": f"{ROOT / 'src'}:{ROOT}"},
        )
        assert self._process.stdout is not None
        assert self._process.stdout.readline() == "ready\n"
        self._frames: list[CanFrame] = []
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()

    def _listen(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            identifier, data = line.strip().split("#")
            self._frames.append(CanFrame(int(identifier, 16), bytes.fromhex(data)))

    def heard(self) -> list[CanFrame]:
        return list(self._frames)

    def emit(self, frame: CanFrame) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(format_frame(frame) + "\n")
        self._process.stdin.flush()

    def close(self) -> None:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.close()
        self._process.wait()
        self._thread.join()
        self._process.stdout.close()


PEERS = ("virtual", "slcan", "socketcan", *(("udp_multicast",) if NETNS in os.environ else ()))


@contextmanager
def open_peer(name: str, patch: pytest.MonkeyPatch) -> Iterator[Peer]:
    """Bring up the other end of a bus."""
    makers: dict[str, Callable[[], Peer]] = {
        "mock": MockPeer,
        "virtual": VirtualPeer,
        "slcan": SlcanPeer,
        "socketcan": lambda: SocketCanPeer(patch),
        "udp_multicast": UdpPeer,
    }
    peer = makers[name]()
    yield peer
    peer.close()
