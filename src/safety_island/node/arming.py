# SPDX-License-Identifier: Apache-2.0
"""Requests to arm the island: each is answered once, in the status."""

from __future__ import annotations

from safety_island.life_cycle.state import State
from safety_island.messages.arm import ArmResult, decode_arm
from safety_island.messages.errors import DecodeError
from safety_island.node.transport import Subscription
from safety_island.platform.interfaces import Logger

_SENDS = (State.READY, State.ACTIVE)


class Arming:
    """``nonce`` and ``result`` are those of the last request."""

    def __init__(self, subscription: Subscription, logger: Logger) -> None:
        self.nonce = 0
        self.result = ArmResult.NONE
        self._subscription = subscription
        self._logger = logger

    def take(self) -> bool:
        """Whether a new request came since the last tick; the same nonce again is not new."""
        sample = self._subscription.take_newest()
        if sample is None:
            return False
        try:
            nonce = decode_arm(sample.data).nonce
        except DecodeError as error:
            self._logger.warning("refused a request to arm: %s", error, throttled=True)
            return False
        is_new = nonce != self.nonce
        self.nonce = nonce
        return is_new

    def answer(self, before: State, after: State) -> None:
        """Note what became of a request, by the states before and after the tick."""
        if before in _SENDS or (before is State.INIT and after is State.READY):
            self.result = ArmResult.NOT_NEEDED
        else:
            self.result = ArmResult.ARMED if after in _SENDS else ArmResult.REFUSED
        self._logger.info("asked to arm: %s", self.result.name.lower().replace("_", " "))
