# SPDX-License-Identifier: Apache-2.0
"""A bridge, its neighbours on loopback, and a loop that drives it until something happened."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from safety_island.bridge.bridge import Bridge
from safety_island.bridge.config_file import read_bridge_file
from safety_island.bridge.link import WaitFor
from safety_island.bridge.routes import plan_routes
from safety_island.cli.domains import reserve
from safety_island.dds.config import URI, DdsConfig
from safety_island.dds.endpoints import Publisher, Subscription
from safety_island.dds.participant import Participant
from tests.conftest import FIRST, LAST

LOOPBACK = DdsConfig(loopback_only=True)
TIMEOUT_S = 20.0


class Rig:
    """Makes bridges and participants; closes them at the end of the test."""

    def __init__(self, stack: ExitStack, folder: Path, domains: tuple[int, ...]) -> None:
        self.domains = domains
        self.said: list[str] = []
        self._stack, self._folder = stack, folder
        self._bridges: list[Bridge] = []

    def bridge(self, text: str, wait_for: WaitFor | None = None) -> Bridge:
        """Start a bridge; A, B, C in ``text`` stand for the domains of the test."""
        for letter, domain in zip("ABC", self.domains, strict=False):
            text = text.replace(f"domain: {letter}", f"domain: {domain}")
        path = self._folder / f"bridge{len(self._bridges)}.yaml"
        path.write_text(text)
        routes = plan_routes([read_bridge_file(str(path))])
        bridge = Bridge(routes, wait_for=wait_for, dds=LOOPBACK, say=self.said.append)
        self._bridges.append(self._stack.enter_context(bridge))
        return bridge

    def stop(self, bridge: Bridge) -> None:
        """End a bridge before the test does."""
        self._bridges.remove(bridge)
        bridge.close()

    def participant(self, letter: str, name: str = "neighbour") -> Participant:
        """Join a domain as somebody else."""
        domain = self.domains["ABC".index(letter)]
        return self._stack.enter_context(Participant(domain, LOOPBACK, name))

    def until(self, condition: Callable[[], object]) -> None:
        """Drive every bridge until the condition holds; fail when it takes too long."""
        end = time.monotonic() + TIMEOUT_S
        while not condition():
            assert time.monotonic() < end, f"did not come about; the bridge said {self.said}"
            self.turn()

    def receive(self, subscription: Subscription, count: int = 1) -> list[bytes]:
        """Drive every bridge until ``count`` samples have come; return them."""
        found: list[bytes] = []

        def enough() -> bool:
            found.extend(sample.data for sample in subscription.take_all())
            return len(found) >= count

        self.until(enough)
        return found

    def match(self, *ends: Publisher | Subscription) -> None:
        """Drive every bridge until all routes are open and every end has found another one."""
        self.until(
            lambda: (
                all(bridge.all_open for bridge in self._bridges)
                and all(end.matched() for end in ends)
            )
        )

    def turn(self) -> None:
        """Drive every bridge through one round."""
        for bridge in self._bridges:
            bridge.look()
            bridge.forward(0.005)

    def settle(self, rounds: int = 60) -> None:
        """Drive every bridge long enough for what should not happen to happen."""
        for _ in range(rounds):
            self.turn()


@pytest.fixture
def rig(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Rig]:
    """Three domains of its own and what works on them."""
    monkeypatch.delenv(URI, raising=False)
    triples = ((first, first + 1, first + 2) for first in range(FIRST, LAST - 2, 3))
    with ExitStack() as stack:
        domains = stack.enter_context(reserve(triples))
        assert domains is not None
        yield Rig(stack, tmp_path, domains)
