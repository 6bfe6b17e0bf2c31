# SPDX-License-Identifier: Apache-2.0
"""The two kinds of inputs: what comes again and again, and what is sent on change."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from safety_island.dds.sample import Sample
from safety_island.input_gate.content import ContentGate
from safety_island.input_gate.latched import LatchedGate
from safety_island.input_gate.newest import in_order, overtaken
from safety_island.input_gate.params import GateParams
from safety_island.input_gate.reason import SampleReason
from safety_island.input_gate.sender_clock import SenderClock
from safety_island.input_gate.stamps import StampGate
from safety_island.node.follower import InputFollower
from safety_island.node.input import Input
from safety_island.node.inputs import InputSpec
from safety_island.node.transport import Subscription
from safety_island.platform.interfaces import Logger


class AgedInput(Input):
    """An input that comes again and again, and that has an age limit."""

    def __init__(
        self,
        spec: InputSpec,
        subscription: Subscription,
        follower: InputFollower,
        logger: Logger,
        params: GateParams,
        sender: SenderClock,
    ) -> None:
        """``sender``: the clock of all inputs, which compares its stamps with theirs."""
        self._stamps = StampGate(spec.age_limit_s(params), sender)
        self._check = None if spec.check is None else partial(spec.check, ContentGate(params))
        super().__init__(spec, subscription, follower, logger, params, self._stamps)

    def _in_order(self, samples: Sequence[Sample]) -> tuple[Sequence[Sample], int]:
        return in_order(samples)

    def _judge(self, message: Any, sample: Sample, now: float) -> SampleReason | None:
        stamps = self._stamps
        data, _, guid = sample
        reason = stamps.judge(message.stamp, data, now, guid != self.source_guid)
        if reason is None and self._check is not None:
            reason = self._check(message, data, stamps)
        return reason


class LatchedInput(Input):
    """An input that is sent on change, and that its publishers keep for late readers."""

    def __init__(
        self,
        spec: InputSpec,
        subscription: Subscription,
        follower: InputFollower,
        logger: Logger,
        params: GateParams,
        sender: SenderClock,
        gives: Callable[[Any], bool],
    ) -> None:
        """``gives``: whether a message gives autonomy; any other one takes it away."""
        self._latched, self._gives = LatchedGate(sender), gives
        super().__init__(spec, subscription, follower, logger, params, self._latched)

    def _receive_anew(self, now: float) -> None:
        """What others said before they were received is not sent again: ask for it."""
        if self.writers.alive:
            self.subscription.renew()
            self.take(now, now)

    def _in_order(self, samples: Sequence[Sample]) -> tuple[Sequence[Sample], int]:
        return self._latched.newest_first(samples), overtaken(samples)

    def _remember(self, samples: Sequence[Sample]) -> None:
        owner = self.writers.owner
        self._latched.remember([sample for sample in samples if sample.writer_guid == owner])

    def _judge(self, message: Any, sample: Sample, now: float) -> SampleReason | None:
        return self._latched.judge(message.stamp, sample, now, self._gives(message))


def make_input(
    spec: InputSpec,
    subscription: Subscription,
    follower: InputFollower,
    logger: Logger,
    params: GateParams,
    sender: SenderClock,
) -> Input:
    """Return the input of a row of the table."""
    rest = subscription, follower, logger, params, sender
    return AgedInput(spec, *rest) if spec.gives is None else LatchedInput(spec, *rest, spec.gives)
