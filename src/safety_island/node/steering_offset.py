# SPDX-License-Identifier: Apache-2.0
"""The offset of the steering sensor, where a topic tells it (Autoware since 0.51).

No tick waits for it: without a publisher the offset is zero, which is the same as off. A sample is
checked before it is used, because the offset moves the steering: it must be finite and within
``steering_offset.input_limit``.
"""

from __future__ import annotations

from safety_island.messages.errors import DecodeError
from safety_island.messages.outputs import decode_float32_stamped
from safety_island.node.follower import Follower
from safety_island.node.transport import Subscription
from safety_island.platform.interfaces import Logger


class SteeringOffset:
    """Passes the newest offset of each tick on; ``refused`` counts what was not accepted."""

    def __init__(self, subscription: Subscription, follower: Follower, logger: Logger) -> None:
        self.refused = 0
        self._subscription, self._follower, self._logger = subscription, follower, logger

    def take(self) -> None:
        """Take what came since the last tick."""
        sample = self._subscription.take_newest()
        if sample is None:
            return
        try:
            _, offset = decode_float32_stamped(sample.data)
        except DecodeError as error:
            self._refuse(str(error))
            return
        if refusal := self._follower.offer_steering_offset(offset):
            self._refuse(f"{offset:g} rad, {refusal.name.lower().replace('_', ' ')}")

    def _refuse(self, why: str) -> None:
        self.refused += 1
        self._logger.warning("refused a steering offset: %s", why, throttled=True)
