# SPDX-License-Identifier: Apache-2.0
"""Steps through the bytes of a sample. Every length is checked against what is left before use.

Each kernel takes the SAMPLE record, and returns GOOD or a DecodeReason.
"""

import numpy as np

from safety_island.input_gate.decode.records import BODY, START
from safety_island.input_gate.decode.text import is_text
from safety_island.input_gate.reason import GOOD
from safety_island.kernel.cdr import HEADER_SIZE, MAX_PADDING, DecodeReason
from safety_island.kernel.kernel import kernel

_ENCAPSULATION = int(DecodeReason.ENCAPSULATION)
_TRUNCATED = int(DecodeReason.TRUNCATED)
_LENGTH = int(DecodeReason.LENGTH)
_STRING = int(DecodeReason.STRING)
_TRAILING = int(DecodeReason.TRAILING)


@kernel
def read_encapsulation(sample):
    """Read the header: plain CDR of either byte order, in bytes that the memory has room for."""
    sample.at = BODY
    if sample.n_bytes < HEADER_SIZE:
        sample.found = HEADER_SIZE
        return _TRUNCATED
    if sample.bytes[START] != 0 or sample.bytes[START + 1] > 1:
        return _ENCAPSULATION
    sample.is_big = 1 - sample.bytes[START + 1]
    if sample.n_bytes > len(sample.bytes) - BODY:
        sample.found = sample.n_bytes
        return _LENGTH
    return GOOD


@kernel
def take(sample, size, alignment):
    """Step over ``size`` bytes from the next multiple of ``alignment`` on; return where they start.

    -1 when the sample ends before.
    """
    start = sample.at + (-sample.at & (alignment - 1))
    sample.found = start + size - START
    if sample.found > sample.n_bytes:
        return -1
    sample.at = start + size
    return start


@kernel
def turn(sample, start, size, count):
    """Turn ``count`` numbers of ``size`` bytes each, where they are big-endian."""
    if sample.is_big == 0:
        return
    data = sample.bytes
    for number in range(count):
        first = start + number * size
        for i in range(size >> 1):
            low, high = first + i, first + size - 1 - i
            data[low], data[high] = data[high], data[low]


@kernel
def read_stamp(sample, message):
    """Read seconds and nanoseconds."""
    start = take(sample, 8, 4)
    if start < 0:
        return _TRUNCATED
    turn(sample, start, 4, 2)
    message.sec = sample.bytes.view(np.int32)[start >> 2]
    message.nanosec = sample.bytes.view(np.uint32)[(start >> 2) + 1]
    return GOOD


@kernel
def take_count(sample):
    """Read a length or a number of elements; -1 when the sample ends before."""
    start = take(sample, 4, 4)
    if start < 0:
        return -1
    number = 0
    for i in range(4):  # not by a view, which may raise for all that LLVM knows of a real call
        place = start + (i if sample.is_big else 3 - i)
        number = (number << 8) | np.int64(sample.bytes[place])
    return number


@kernel
def read_string(sample):
    """Read a string: ``text_at`` and ``text_size`` say where it stands."""
    length = take_count(sample)
    if length < 0:
        return _TRUNCATED
    start = take(sample, length, 1)
    if start < 0:
        return _TRUNCATED
    sample.text_at = start
    sample.text_size = max(length - 1, 0)
    end = start + sample.text_size
    if length > 0 and sample.bytes[end] != 0:
        return _STRING
    return GOOD if is_text(sample.bytes, start, end) else _STRING


@kernel
def read_frame(sample, message):
    """Read a stamp and the name of a frame, as in std_msgs/msg/Header."""
    reason = read_stamp(sample, message)
    if reason != GOOD:
        return reason
    reason = read_string(sample)
    message.frame_at = sample.text_at
    message.frame_size = sample.text_size
    return reason


@kernel
def check_end(sample):
    """Whether nothing but padding follows what was read."""
    sample.found = sample.n_bytes - (sample.at - START)
    return _TRAILING if sample.found > MAX_PADDING else GOOD
