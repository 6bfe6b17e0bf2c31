# SPDX-License-Identifier: Apache-2.0
"""The five inputs together: who publishes them, what is missing, too old, or out of place."""

from __future__ import annotations

import math
from operator import gt
from typing import NamedTuple

from safety_island.control.release import RELEASES
from safety_island.input_gate.params import GateParams
from safety_island.input_gate.sender_clock import SenderClock
from safety_island.input_gate.writers import WINDOW_S
from safety_island.life_cycle.reason import Reason
from safety_island.messages.inputs import Odometry, OperationMode, Steering
from safety_island.node.follower import InputFollower
from safety_island.node.input_kinds import make_input
from safety_island.node.input_warnings import InputWarnings
from safety_island.node.inputs import gives_autonomy, inputs_of
from safety_island.node.transport import Transport
from safety_island.platform.interfaces import Clock, Logger

TRAJECTORY = 0
ODOMETRY = 1
STEERING = 2
OPERATION_MODE = 4
"""Places in the table of inputs."""

_NONE = Reason.NONE

NO_SUBJECT = 255
"""Stands for: the reason is about no input."""


class Blocked(NamedTuple):
    """Why nothing may be sent, and the input that it is about."""

    reason: Reason
    subject: int = NO_SUBJECT


NOT_BLOCKED = Blocked(Reason.NONE)


class InputSet:
    """The inputs of a node. Times in s, monotonic."""

    def __init__(
        self,
        transport: Transport,
        follower: InputFollower,
        clock: Clock,
        logger: Logger,
        params: GateParams,
        release: str = RELEASES[0],
    ) -> None:
        """``release``: the release of Autoware whose topics are subscribed to."""
        self._specs = inputs_of(release)
        sender = SenderClock()
        self.items = tuple(
            make_input(
                spec,
                transport.subscription(
                    spec.topic.name, spec.topic.type_name, spec.topic.subscription_qos
                ),
                follower,
                logger,
                params,
                sender,
            )
            for spec in self._specs
        )
        self._mode = self.items[OPERATION_MODE]
        self._transport = transport
        self._logger = logger
        self._keeps_first = params.second_publisher == "keep_first"
        self._watch = InputWarnings(self.items, sender, params, clock, logger)
        self.ages_s = [math.inf] * len(self.items)
        """Age of each, as of the last ``measure``."""
        self.disengaged = Reason.WAITING_FOR_INPUT
        """Why the vehicle is not under control, NONE when it is, as of the last ``take``."""
        self.are_complete = False
        """Whether a sample of every input was accepted."""
        self._unsettled_until = -math.inf
        self._has_others = False
        self._age_limits = [item.age_limit_s for item in self.items]
        self._usual_ages = [min(item.age_limit_s, item.age_warning_s) for item in self.items]
        self._are_fresh = False
        """Whether no age is worth a warning or beyond its limit, as of the last ``measure``."""

    def discover(self, now: float) -> None:
        """Look which publishers live; to be called when some came or went."""
        for item, spec in zip(self.items, self._specs, strict=True):
            others = item.writers.others
            item.discover(self._transport.writers(item.topic, spec.topic.type_name), now)
            if item.writers.others > others:
                self._logger.warning("%s has %d publishers", item.topic, item.writers.others + 1)
        self._unsettled_until = now + WINDOW_S
        self._has_others = any(item.writers.others for item in self.items)

    def take(self, now: float, since: float) -> int:
        """Take what came since the last tick; return how many samples were refused."""
        refused = 0
        for item in self.items:
            refused += item.take(now, since)
        self.measure(now)
        self.disengaged = self._disengaged()
        return refused

    def measure(self, now: float) -> None:
        """Take the age of each."""
        self.ages_s = ages_s = [now - item.accepted_at for item in self.items]
        self._are_fresh = not any(map(gt, ages_s, self._usual_ages))

    def drop(self) -> None:
        """Drop what has waited while the process stood still; the operation mode stays."""
        for item in self.items:
            if item is not self._mode:
                item.drop()

    def blocked(self, now: float) -> Blocked:
        """Return what forbids to send, the first that counts."""
        if not self.are_complete and (found := self._missing()):
            return found
        if now <= self._unsettled_until and (found := self._flapping(now)):
            return found
        if not self._keeps_first and (found := self._shared()):
            return found
        return NOT_BLOCKED if self._are_fresh else self._stale()

    def _missing(self) -> Blocked | None:
        for index, item in enumerate(self.items):
            if not item.accepted:
                return Blocked(Reason.WAITING_FOR_INPUT, index)
        self.are_complete = True
        return None

    def _flapping(self, now: float) -> Blocked | None:
        for index, item in enumerate(self.items):
            if item.writers.flaps(now):
                return Blocked(Reason.WRITER_FLAPPING, index)
        return None

    def _shared(self) -> Blocked | None:
        for index, item in enumerate(self.items):
            if item.writers.others:
                return Blocked(Reason.SECOND_PUBLISHER, index)
        return None

    def _stale(self) -> Blocked:
        too_old = list(map(gt, self.ages_s, self._age_limits))
        if True not in too_old:
            return NOT_BLOCKED
        if all(too_old[:OPERATION_MODE]):
            return Blocked(Reason.PARTITION)
        return Blocked(Reason.INPUT_STALE, too_old.index(True))

    def lacks_only_a_path(self, now: float) -> bool:
        """Whether the trajectory alone is too old, and those that come cannot be used."""
        too_old = list(map(gt, self.ages_s, self._age_limits))
        is_alone = too_old[TRAJECTORY] and not any(too_old[TRAJECTORY + 1 :])
        return is_alone and self.items[TRAJECTORY].is_unusable(now)

    def missing(self) -> list[str]:
        """Name the inputs of which no sample was ever accepted."""
        return [item.name for item in self.items if not item.accepted]

    def warn(self, now: float) -> None:
        """Look which warnings stand, and log those that are new."""
        is_calm = self._are_fresh and now > self._unsettled_until and not self._has_others
        self._watch.update(now, self.ages_s, is_calm)

    @property
    def warnings(self) -> list[int]:
        """Bits of InputWarning for each input, as of the last tick."""
        return self._watch.bits

    @property
    def operation_mode(self) -> OperationMode | None:
        """The operation mode in force, None before the first."""
        found: OperationMode | None = self._mode.message
        return found

    def steering(self) -> float:
        """Return the tyre angle [rad] that was measured last; 0 before the first time."""
        message: Steering | None = self.items[STEERING].message
        return 0.0 if message is None else message.steering_tire_angle

    def _disengaged(self) -> Reason:
        mode = self._mode
        state: OperationMode | None = mode.message
        if state is None:
            return Reason.WAITING_FOR_INPUT
        if mode.source_guid not in mode.writers.alive:  # another one has said nothing yet
            return Reason.MODE_WRITER_GONE
        return _NONE if gives_autonomy(state) else Reason.NOT_AUTONOMOUS

    def speed(self) -> float:
        """Return the speed [m/s] that was measured last; 0 before the first time."""
        message: Odometry | None = self.items[ODOMETRY].message
        return 0.0 if message is None else message.vx
