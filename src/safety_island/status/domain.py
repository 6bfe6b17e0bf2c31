# SPDX-License-Identifier: Apache-2.0
"""What discovery knows of the publishers of the inputs: why nothing comes from them."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from safety_island.dds.discovery import RemoteEndpoint
from safety_island.dds.mismatch import why_not
from safety_island.dds.qos import Qos
from safety_island.dds.topics import STATUS
from safety_island.life_cycle.reason import Explanation, Reason
from safety_island.messages.status_fields import InputStatus, Status
from safety_island.node.input_set import OPERATION_MODE
from safety_island.node.inputs import INPUTS

_ABOUT_AN_INPUT = (Reason.WAITING_FOR_INPUT, Reason.INPUT_STALE, Reason.MODE_WRITER_GONE)

_SETTINGS = "'island env' prints the settings that a program needs to be found"


class Endpoints(Protocol):
    """The endpoints of others on a ROS topic; a Participant."""

    def publications(self, topic: str) -> list[RemoteEndpoint]:
        """Return the publishers, whatever their type."""

    def subscriptions(self, topic: str) -> list[RemoteEndpoint]:
        """Return the subscriptions, whatever their type."""


class Publishers(NamedTuple):
    """The publishers on the topic of an input."""

    topic: str
    matching: int
    mismatches: tuple[str, ...]
    """One line for each publisher that does not match the island's subscription."""


class Domain:
    """The publishers of the inputs as of now; ``where`` names domain and interface."""

    def __init__(self, endpoints: Endpoints, where: str) -> None:
        self._endpoints, self._where = endpoints, where

    def explain(self, status: Status, reason: int) -> Explanation | None:
        """Say why what a reason is about does not come; None when discovery has no part in it.

        Samples that come and are refused have a reason of their own.
        """
        if reason == Reason.PARTITION:
            return self._no_input()
        place = OPERATION_MODE if reason == Reason.MODE_WRITER_GONE else status.subject
        if reason not in _ABOUT_AN_INPUT or place >= len(status.inputs):
            return None
        item = status.inputs[place]
        return None if item.refused_in_a_row else self._nothing_comes(place, item)

    def publishers(self, place: int) -> Publishers:
        """Return the publishers of an input by its place in the status."""
        entry = INPUTS[place].topic
        type_name, qos = self._subscription(entry.name, entry.type_name, entry.subscription_qos)
        found = self._endpoints.publications(entry.name)
        lines = [why_not(remote, type_name, qos, publisher=True) for remote in found]
        wrong = tuple(line for line in lines if line)
        return Publishers(entry.name, len(found) - len(wrong), wrong)

    def _subscription(self, topic: str, type_name: str, qos: Qos) -> tuple[str, Qos]:
        """Return what the island itself subscribes with; the table's where it is not seen."""
        islands = {remote.participant for remote in self._endpoints.publications(STATUS.name)}
        for remote in self._endpoints.subscriptions(topic):
            if remote.participant in islands:
                return remote.type_name, remote.qos
        return type_name, qos

    def _nothing_comes(self, place: int, item: InputStatus) -> Explanation:
        topic, matching, mismatches = self.publishers(place)
        if matching:
            return _silent(topic, matching, bool(item.received))
        if mismatches:
            return Explanation(
                "; ".join(mismatches),
                "let it publish with the type and at least the QoS that docs/topics.md names",
            )
        return Explanation(
            f"no publisher is on {topic} on {self._where}",
            f"start its publisher or 'island bridge', on this domain and interface; {_SETTINGS}",
        )

    def _no_input(self) -> Explanation | None:
        """Every input is too old; None when there are publishers."""
        found = [self.publishers(place) for place in range(len(INPUTS))]
        if any(publishers.matching or publishers.mismatches for publishers in found):
            return None
        return Explanation(
            f"no publisher of any input is on {self._where}",
            "start 'island bridge', and look at the network between main compute and island;"
            f" {_SETTINGS}",
        )


def _silent(topic: str, matching: int, came: bool) -> Explanation:
    who = "its publisher is" if matching == 1 else f"{matching} publishers are"
    news = "nothing new comes" if came else "nothing comes"
    return Explanation(
        f"{who} on {topic} and matches, but {news} from it",
        "look whether it publishes, at its DDS partition, and at the network (firewall, multicast,"
        " fragments) between it and the island",
    )
