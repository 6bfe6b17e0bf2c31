# SPDX-License-Identifier: Apache-2.0
"""Which of the samples that came between two ticks is looked at."""

from __future__ import annotations

import math
from collections.abc import Sequence
from struct import Struct
from typing import Protocol, TypeVar

from safety_island.kernel.cdr import CDR_LE, HEADER_SIZE

_STAMP = Struct("<iI")
_SMALLEST = HEADER_SIZE + _STAMP.size
NO_STAMP: tuple[float, ...] = (-math.inf,)
"""Is lower than every stamp (seconds, nanoseconds)."""

TRIES = 3
"""How many samples of one tick are looked at, the newest first, until one is accepted."""


class Sample(Protocol):
    """One received message."""

    @property
    def data(self) -> bytes:
        """Serialized message that begins with a stamp."""


S = TypeVar("S", bound=Sample)


def newest_first(samples: Sequence[S]) -> Sequence[S]:
    """Return at most TRIES samples in the order in which they are tried.

    ``samples`` are in the order of arrival; the highest stamp comes first, of equal ones the last
    arrival. What has no stamp that can be read comes last.
    """
    if len(samples) == 1:
        return samples
    arrival = range(len(samples))
    order = sorted(arrival, key=lambda i: (read_stamp(samples[i].data), i), reverse=True)
    return [samples[i] for i in order[:TRIES]]


def in_order(samples: Sequence[S]) -> tuple[Sequence[S], int]:
    """Return what ``newest_first`` and ``overtaken`` do, in half the time where none was."""
    if len(samples) == 1:
        return samples, 0
    stamps = [read_stamp(sample.data) for sample in samples]
    if stamps == sorted(stamps):
        return samples[: -TRIES - 1 : -1], 0
    return newest_first(samples), overtaken(samples)


def overtaken(samples: Sequence[S]) -> int:
    """Count the samples that arrived after one with a higher stamp."""
    highest, count = NO_STAMP, 0
    for sample in samples:
        stamp = read_stamp(sample.data)
        if stamp < highest:
            count += 1
        else:
            highest = stamp
    return count


def read_stamp(data: bytes) -> tuple[float, ...]:
    """Return seconds and nanoseconds of a message's stamp, NO_STAMP when it has none."""
    if data[:2] != CDR_LE or len(data) < _SMALLEST:
        return NO_STAMP
    return _STAMP.unpack_from(data, HEADER_SIZE)
