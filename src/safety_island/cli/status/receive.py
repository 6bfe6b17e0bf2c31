# SPDX-License-Identifier: Apache-2.0
"""Receives the status of an island, bounded in time."""

from __future__ import annotations

import argparse
from collections.abc import Callable

from safety_island.cli import options
from safety_island.dds.participant import Participant
from safety_island.dds.topics import STATUS
from safety_island.errors import IslandError
from safety_island.messages.errors import DecodeError
from safety_island.messages.status import decode_status
from safety_island.messages.status_fields import Status
from safety_island.platform.posix.clock import PosixClock
from safety_island.status.domain import Domain

SLICE_S = 0.1
"""Longest wait at a time, so that a signal is heard."""

WATCH_S = 1.0
"""What comes and goes from tick to tick is looked for in that many seconds."""


class StatusReader:
    """A participant that reads the status; a context manager that closes it."""

    def __init__(self, arguments: argparse.Namespace, node_name: str) -> None:
        """Join the domain. ``arguments``: ``domain`` and ``interface`` of the command line."""
        self.where = f"domain {arguments.domain}, interface {arguments.interface}"
        self.clock = PosixClock()
        self.came = False
        """Whether any status came."""
        self.participant = Participant(arguments.domain, options.dds_config(arguments), node_name)
        qos = STATUS.subscription_qos
        self._subscription = self.participant.subscription(STATUS.name, STATUS.type_name, qos)

    def now(self) -> float:
        """Monotonic time [s]."""
        return self.clock.monotonic_ns() / 1e9

    def take(self, timeout_s: float = SLICE_S) -> list[Status]:
        """Return what came since the last call, oldest first; wait for it when nothing has."""
        self.participant.wait(min(timeout_s, SLICE_S))
        samples = self._subscription.take_all()
        self.came = self.came or bool(samples)
        try:
            return [decode_status(sample.data) for sample in samples]
        except DecodeError as error:
            raise IslandError(
                f"the status on {self.where} cannot be read ({error}); use the version of the"
                " island here"
            ) from None

    def find(self, wanted: Callable[[Status], bool], timeout_s: float) -> Status | None:
        """Return the first status that is wanted, from those to come within ``timeout_s``."""
        end = self.now() + timeout_s
        while (left := end - self.now()) > 0.0:
            for status in self.take(left):
                if wanted(status):
                    return status
        return None

    def first(self, timeout_s: float) -> Status:
        """Return the first status that comes. Raises IslandError when none does in time."""
        status = self.find(lambda _: True, timeout_s)
        if status is None:
            raise self.nothing(timeout_s)
        return status

    def recent(self, timeout_s: float) -> list[Status]:
        """Return the first status that comes, and those of the next WATCH_S, oldest first.

        Meanwhile discovery finds the publishers of the domain. Raises IslandError as ``first``.
        """
        found = [self.first(timeout_s)]
        end = self.now() + WATCH_S
        while (left := end - self.now()) > 0.0:
            found += self.take(left)
        return found

    def publishers(self) -> Domain:
        """Return what discovery knows of the publishers of the inputs."""
        return Domain(self.participant, self.where)

    def nothing(self, timeout_s: float) -> IslandError:
        """Return the error for an island that is not heard."""
        looked = f"no status came within {timeout_s:g} s on {STATUS.name} ({self.where})"
        if wrong := self.participant.mismatches():
            return IslandError(f"{looked}: {wrong[0]}")
        if self.participant.publications(STATUS.name):
            return IslandError(
                f"{looked}, though its publisher is there: the island stands still; look at its"
                " process and its log"
            )
        return IslandError(
            f"{looked}; start 'island run', or name its --domain and --interface here ('island env'"
            " prints the DDS settings that meet an island)"
        )

    def close(self) -> None:
        """Leave the domain."""
        self.participant.close()

    def __enter__(self) -> StatusReader:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
