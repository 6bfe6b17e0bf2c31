# SPDX-License-Identifier: Apache-2.0
"""Whether another island is on the domain, and which of the two was there first.

Whoever finds another one while it still looks around is the newcomer, and does not arm as long as
that one lives. Two that start at the same moment both wait, until one is stopped.

``w`` is ISLANDS; times in s, monotonic. The table of publishers holds MAX_PUBLISHERS. Of those that
find no place in it, one may have been there first, and this is assumed until no other is left.
"""

from safety_island.kernel.kernel import entry, kernel
from safety_island.life_cycle.limits import MAX_PUBLISHERS
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.records import ISLANDS, PUBLISHERS

NONE = int(Reason.NONE)
DISCOVERING = int(Reason.DISCOVERING)
WRITER_FLAPPING = int(Reason.WRITER_FLAPPING)
SECOND_PUBLISHER = int(Reason.SECOND_PUBLISHER)
SECOND_ISLAND = int(Reason.SECOND_ISLAND)


@kernel
def update(w, seen, now):
    """Note which other publishers (PUBLISHERS) of the control command live now."""
    copy_all(w.others, seen)
    w.others.n = seen.n
    is_first_look = now <= w.ready_at or not w.has_looked  # which may come late
    w.has_looked = True
    if is_first_look:
        copy_all(w.earlier, seen)
        w.assumes_earlier = False
    else:
        keep_common(w.earlier, seen)
    w.assumes_earlier = seen.n > MAX_PUBLISHERS or (w.assumes_earlier and seen.n > 0)


@kernel
def copy_all(to, source):
    """Copy the publishers that the table holds."""
    to.n = min(source.n, MAX_PUBLISHERS)
    for i in range(to.n):
        copy_guid(to.guids[i], source.guids[i])


@kernel
def copy_guid(to, source):
    """Copy a GUID."""
    to.first = source.first
    to.last = source.last


@kernel
def keep_common(kept, seen):
    """Drop the publishers that are not among those ``seen``."""
    n = 0
    for i in range(kept.n):
        if holds(seen, kept.guids[i]):
            copy_guid(kept.guids[n], kept.guids[i])
            n += 1
    kept.n = n


@kernel
def holds(seen, guid):
    """Whether a publisher is in the table."""
    for i in range(min(seen.n, MAX_PUBLISHERS)):
        if seen.guids[i].first == guid.first and seen.guids[i].last == guid.last:
            return True
    return False


@kernel
def is_newcomer(w):
    """Whether one that was there before still lives."""
    return w.earlier.n > 0 or w.assumes_earlier


@kernel
def looks_around(w, now):
    """Whether it is too early to say that there is no other."""
    return now < w.ready_at


@kernel
def blocked(w, flaps, keeps_first, now):
    """Reason why nothing may be sent because of other publishers of the command; NONE: it may.

    ``flaps``: they came and went too often; ``keeps_first``: later ones are let be.
    """
    if is_newcomer(w):
        return SECOND_ISLAND
    if looks_around(w, now):
        return DISCOVERING
    if flaps:
        return WRITER_FLAPPING
    if w.others.n > 0 and not keeps_first:
        return SECOND_PUBLISHER
    return NONE


@entry(ISLANDS, PUBLISHERS, float)
def islands_update(islands, seen, now):
    """Note which other publishers of the control command live now."""
    update(islands[0], seen[0], now)
    return 0


@entry(ISLANDS)
def islands_newcomer(islands):
    """1 when an island that was there before still lives."""
    return int(is_newcomer(islands[0]))


@entry(ISLANDS, float)
def islands_look_around(islands, now):
    """1 when it is too early to say that there is no other island."""
    return int(looks_around(islands[0], now))


@entry(ISLANDS, int, int, float)
def islands_blocked(islands, flaps, keeps_first, now):
    """Reason why nothing may be sent because of other publishers of the command; 0: it may."""
    return blocked(islands[0], flaps != 0, keeps_first != 0, now)
