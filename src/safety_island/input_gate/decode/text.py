# SPDX-License-Identifier: Apache-2.0
"""Whether bytes are text: UTF-8 (RFC 3629: shortest forms, no surrogates) without a NUL."""

from safety_island.kernel.kernel import kernel


@kernel
def is_text(data, at, end):
    """Whether the bytes from ``at`` up to ``end`` are text."""
    while at < end:
        size = _character(data, at, end)
        if size == 0:
            return False
        at += size
    return True


@kernel
def _character(data, at, end):
    """Bytes of the character at ``at``; 0 when there is none, or it is NUL."""
    lead = data[at]
    if lead < 0x80:
        return 1 if lead > 0 else 0
    if lead < 0xC2 or lead > 0xF4:
        return 0
    size = 2 if lead < 0xE0 else (3 if lead < 0xF0 else 4)
    if at + size > end or not _is_second(lead, data[at + 1]):
        return 0
    for place in range(at + 2, at + size):
        if data[place] < 0x80 or data[place] > 0xBF:
            return 0
    return size


@kernel
def _is_second(lead, byte):
    """Whether a byte may follow the first of a character: some ranges have a shorter form."""
    lowest, highest = 0x80, 0xBF
    if lead == 0xE0:
        lowest = 0xA0
    elif lead == 0xED:  # surrogates
        highest = 0x9F
    elif lead == 0xF0:
        lowest = 0x90
    elif lead == 0xF4:  # beyond U+10FFFF
        highest = 0x8F
    return lowest <= byte <= highest
