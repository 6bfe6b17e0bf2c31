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
from safety_island.gate.clock_gap import clock_gap_s
from safety_island.gate.content import ContentGate
from safety_island.gate.newest import newest_first, overtaken
from safety_island.gate.params import GateParams
from safety_island.gate.rate import RateMeter
from safety_island.gate.reason import UNUSABLE, SampleReason
from safety_island.gate.stamps import StampGate
from safety_island.gate.writers import Writers
from safety_island.messages.errors import DecodeError
from safety_island.messages.status import INPUT_RECORD, NO_VALUE
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
    ) -> None:
        self.name = spec.name
        self.topic = spec.topic.name
        self.subscription = subscription
        self.stamps = StampGate(spec.age_limit_s(params))
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
        self._other: Sample | None = None
        """The newest sample of a publisher that the island does not keep to."""
        self._decode = spec.decoder(follower)
        self._check = None if spec.check is None else partial(spec.check, ContentGate(params))
        self._offer, self._values = spec.offer(follower), spec.values
        self._count = None if spec.replaced is None else partial(spec.replaced, follower)
        self._logger = logger

    def take(self, now: float, since: float) -> int:
        """Take what came after ``since`` [s], the tick before; return how many were refused."""
        samples = self.subscription.take_all()
        if not samples:
            return 0
        self._taken_at = now
        if len(samples) == 1 and not self.writers.others:
            return 0 if self._accept(samples[0], now, since) else 1
        samples, refused = self._select(samples)
        for sample in samples:
            if self._accept(sample, now, since):
                break
            refused += 1
        return refused

    def _select(self, samples: Sequence[Sample]) -> tuple[Sequence[Sample], int]:
        """Return the samples to be looked at, the newest first, and how many others published."""
        found, foreign = samples, 0
        if self.writers.others:
            found, foreign = self._without_foreign(samples)
        self.superseded += max(len(found) - 1, 0)
        self.overtaken += overtaken(found)
        return newest_first(found), foreign

    def _without_foreign(self, samples: Sequence[Sample]) -> tuple[Sequence[Sample], int]:
        """Leave out what others published, so that it cannot crowd out the owner's samples."""
        found = []
        for sample in samples:
            if self.writers.takes(sample.writer_guid):
                found.append(sample)
            else:
                self._other = sample
                self._refuse(SampleReason.OTHER_PUBLISHER)
        return found, len(samples) - len(found)

    def hand_over(self, now: float) -> None:
        """The publisher that was kept to is gone: take what another one has said meanwhile."""
        sample, self._other = self._other, None
        self.stamps.forget()  # the next one may have another clock, or tell the same again
        lives = sample is not None and sample.writer_guid in self.writers.alive
        if sample is not None and lives:
            self._accept(sample, now, now)

    def watch(self, now: float, wall_ns: int) -> None:
        """Look at what changes slowly: how often it comes, and by which clock."""
        self.rate.look(self.subscription.received, now)
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
        data, _, guid = sample
        self.taken, self.writer_guid = sample, guid
        stamps = self.stamps
        try:
            message = self._decode(data)
            if guid != self.writers.owner and not self.writers.takes(guid):
                self._other = sample
                return self._refuse(SampleReason.OTHER_PUBLISHER)
            reason = stamps.judge(message.stamp, data, now, guid != self.source_guid)
            if reason is None and self._check is not None:
                reason = self._check(message, data, stamps)
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
        stamps.hold(data, now)
        self.source_guid, self.message, self.accepted_at = guid, message, since
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

    def is_unusable(self, now: float) -> bool:
        """Whether its publisher has sent samples within the age limit, but none can be used."""
        return self.refused_in_a_row > 0 and now - self.unusable_at <= self.age_limit_s

    def _refuse(self, reason: SampleReason, detail: str = "") -> bool:
        detail = detail or reason.name.lower().replace("_", " ")
        self.refused[reason] += 1
        _COUNT.pack_into(self.refusals, _COUNT.size * reason, self.refused[reason])
        self.refused_in_a_row += 1
        self.last_refusal = reason
        if reason in UNUSABLE:
            self.unusable_at = self._taken_at
        site = f"{self.topic} {reason.name}"
        self._logger.warning("refused a sample: %s", detail, throttled=True, site=site)
        return False
