# SPDX-License-Identifier: Apache-2.0
"""One input of the controller node at work.

The way of a sample: of those that came since the last tick the newest, decode, gate (publisher,
stamp, frame), offer (every value). Whatever refuses a sample is counted here by its reason, and
leaves the controllers as they were.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from functools import partial
from struct import Struct
from typing import Any

from safety_island.dds.sample import Sample
from safety_island.input_gate.clock_gap import clock_gap_s
from safety_island.input_gate.latched import LatchedGate
from safety_island.input_gate.params import GateParams
from safety_island.input_gate.rate import RateMeter
from safety_island.input_gate.reason import UNUSABLE, SampleReason
from safety_island.input_gate.stamps import StampGate
from safety_island.input_gate.writers import Writers
from safety_island.messages.errors import DecodeError
from safety_island.messages.status import INPUT_RECORD, NO_VALUE
from safety_island.messages.wire import Time
from safety_island.node.follower import InputFollower
from safety_island.node.inputs import InputSpec
from safety_island.node.report import describe
from safety_island.node.transport import Subscription
from safety_island.platform.interfaces import Logger

_COUNT = Struct("<I")


class Input:
    """One input at work: its subscription, what became of its samples, and its age.

    The moment of receipt lies between two ticks, and only the island's own clock counts, so an age
    runs from the earlier tick: the output ends in time even when the sample came at once after it.
    """

    def __init__(
        self,
        spec: InputSpec,
        subscription: Subscription,
        follower: InputFollower,
        logger: Logger,
        params: GateParams,
        stamps: StampGate | LatchedGate,
    ) -> None:
        """``stamps`` checks the stamps of its samples."""
        self.name = spec.name
        self.topic = spec.topic.name
        self.subscription = subscription
        self.stamps = stamps
        self.writers = Writers(params.writer_changes)
        self.rate = RateMeter(spec.topic.rate_hz)
        self.age_limit_s = spec.age_limit_s(params)
        self.age_warning_s = spec.age_warning_s(params)
        self.warnings = 0
        """Bits of InputWarning, as of the last tick."""
        self.accepted = 0
        self.superseded = 0
        """Samples passed over for a newer one."""
        self.overtaken = 0
        """Samples that arrived after a newer one."""
        self.refused: Counter[SampleReason] = Counter()
        """Samples refused, by reason."""
        self.refusals = bytearray(INPUT_RECORD["refused"].itemsize)
        """The same, as the status has it."""
        self.refused_in_a_row = 0
        self.last_refusal: int = NO_VALUE
        """The SampleReason of the last one, NO_VALUE when none was refused."""
        self.accepted_at = -math.inf
        """Monotonic time [s] before which the sample in force was not received."""
        self.replaced = 0
        """Values replaced in the sample in force, since they contradicted others of it."""
        self.replaced_total = 0
        self.unusable_at = -math.inf
        """Monotonic time [s] when a new sample of its publisher was last refused for what it is."""
        self._taken_at = -math.inf
        self.clock_gap_s = 0.0
        """Between its stamps and the wall clock, as of the last ``watch``."""
        self.taken: Sample | None = None
        """The sample that was looked at last."""
        self.writer_guid = b""
        """Its writer."""
        self.source_guid = b""
        """Writer of the sample in force."""
        self.message: Any = None
        """The sample in force, decoded."""
        self.source_ns = 0
        """When it was published, by its sender's clock; 0 before the first."""
        self._kept_to = b""
        """From whom alone the subscription receives; empty: from all."""
        self._kept_out = 0
        """Samples of others that it has kept out, as counted here."""
        self._decode = spec.decoder(follower)
        self._offer, self._values = spec.offer(follower), spec.values
        self._count = None if spec.replaced is None else partial(spec.replaced, follower)
        self._logger = logger

    def take(self, now: float, since: float) -> int:
        """Take what came after ``since`` [s], the tick before; return how many were refused."""
        refused = self._count_kept_out() if self.writers.others else 0
        samples = self.subscription.take_all()
        if not samples:
            return refused
        self._taken_at = now
        if len(samples) == 1 and not self.writers.others:
            refused += not self._accept(samples[0], now, since)
        else:
            samples, foreign = self._without_foreign(samples)
            refused += foreign + self._take_newest(samples, now, since)
        self._remember(samples)
        return refused

    def _take_newest(self, samples: Sequence[Sample], now: float, since: float) -> int:
        """Accept the newest good one; return how many were refused before it."""
        self.superseded += max(len(samples) - 1, 0)
        tried, count = self._in_order(samples)
        self.overtaken += count
        refused = 0
        for sample in tried:
            if self._accept(sample, now, since):
                break
            refused += 1
        return refused

    def _without_foreign(self, samples: Sequence[Sample]) -> tuple[Sequence[Sample], int]:
        """Leave out what others published, so that it cannot crowd out the owner's samples."""
        if not self.writers.others:
            return samples, 0
        found = [sample for sample in samples if self._admits(sample.writer_guid)]
        foreign = len(samples) - len(found)
        if foreign:
            self._refuse(SampleReason.OTHER_PUBLISHER, count=foreign)
        return found, foreign

    def _admits(self, guid: bytes) -> bool:
        """Whether a publisher's samples are taken; from then on it alone is received."""
        admits = self.writers.takes(guid)
        if self._kept_to != self.writers.owner:
            self._kept_to = self.writers.owner
            self.subscription.keep_to(self._kept_to)
        return admits

    def _count_kept_out(self) -> int:
        """Count what others published and the subscription has kept out since the last tick."""
        count = self.subscription.kept_out - self._kept_out
        if count:
            self._kept_out += count
            self._refuse(SampleReason.OTHER_PUBLISHER, count=count)
        return count

    def discover(self, alive: frozenset[bytes], now: float) -> None:
        """Note which publishers live now; when the owner is gone, receive from all again."""
        self.writers.update(alive, now)
        owner = self.writers.owner
        if not self._kept_to or (owner and self.subscription.keep_to(owner)):
            return
        self._kept_to = b""
        self.subscription.keep_to(b"")
        self._receive_anew(now)

    def _receive_anew(self, now: float) -> None:
        """What others said before is kept out for good; what comes next is received."""

    def _in_order(self, samples: Sequence[Sample]) -> tuple[Sequence[Sample], int]:
        """Return the samples of one tick in the order in which they are tried.

        And how many arrived after a newer one.
        """
        raise NotImplementedError

    def _remember(self, samples: Sequence[Sample]) -> None:
        """Note what was received, whatever became of it."""

    def _judge(self, message: Any, sample: Sample, now: float) -> SampleReason | None:
        """Say why a decoded sample is refused, None when it is good."""
        raise NotImplementedError

    def watch(self, now: float, wall_ns: int) -> None:
        """Look at what changes slowly: how often it comes, and by which clock."""
        self.rate.look(self.subscription.received, now)
        self.stamps.fade()
        if self.message is not None:
            stamp_ns = self.message.stamp.nanoseconds
            self.clock_gap_s = clock_gap_s(stamp_ns, wall_ns, now - self.accepted_at)

    def drop(self) -> None:
        """Drop what waits to be taken, and forget when the sample in force came."""
        self.subscription.take_all()
        self.accepted_at = -math.inf

    def _accept(self, sample: Sample, now: float, since: float) -> bool:
        """Pass a sample through the gate to the controllers; whether it got there.

        It was received after ``since`` [s].
        """
        data, source_ns, guid = sample
        self.taken, self.writer_guid = sample, guid
        try:
            message = self._decode(data)
            if guid != self.writers.owner and not self._admits(guid):
                return self._refuse(SampleReason.OTHER_PUBLISHER)
            reason = self._judge(message, sample, now)
            if reason is not None:
                return self._refuse(reason)
            if verdict := self._offer(*self._values(message)):
                return self._refuse(SampleReason[verdict.name])
        except DecodeError as error:
            return self._refuse(SampleReason[error.reason.name], str(error))
        except MemoryError:
            raise
        except Exception as error:  # a fault of ours must not let one topic stop the ticks
            return self._refuse(SampleReason.FAULT, describe(error))
        self.stamps.hold(data, now)
        self.source_guid, self.message, self.accepted_at = guid, message, since
        self.source_ns = source_ns
        self.accepted += 1
        self.refused_in_a_row = 0
        if self._count is not None:
            self._note_replaced(self._count())
        return True

    def _note_replaced(self, count: int) -> None:
        """Note how many values of the new sample were replaced."""
        self.replaced = count
        if count:
            self.replaced_total += count
            self.stamps.on_unusual()
            text = "%d orientations contradict the path and were replaced, %d since the start"
            site = f"{self.topic} replaced"
            self._logger.warning(text, count, self.replaced_total, throttled=True, site=site)

    @property
    def stamp_ns(self) -> int:
        """Stamp of the sample in force, by its sender's clock [ns]; 0 before the first."""
        stamp: Time | None = None if self.message is None else self.message.stamp
        return 0 if stamp is None else stamp.nanoseconds

    def is_unusable(self, now: float) -> bool:
        """Whether its publisher has sent samples within the age limit, but none can be used."""
        return self.refused_in_a_row > 0 and now - self.unusable_at <= self.age_limit_s

    def _refuse(self, reason: SampleReason, detail: str = "", count: int = 1) -> bool:
        detail = detail or reason.name.lower().replace("_", " ")
        self.refused[reason] += count
        _COUNT.pack_into(self.refusals, _COUNT.size * reason, self.refused[reason])
        self.refused_in_a_row += count
        self.last_refusal = reason
        if reason in UNUSABLE:
            self.unusable_at = self._taken_at
        site = f"{self.topic} {reason.name}"
        self._logger.warning("refused a sample: %s", detail, throttled=True, site=site)
        return False
