# SPDX-License-Identifier: Apache-2.0
"""Quality of service as the C library holds it: made for ours, read from that of others."""

from __future__ import annotations

import ctypes as ct
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from safety_island.dds.library.layouts import DURATION
from safety_island.dds.library.loading import Library, loaded
from safety_island.dds.qos import (
    INFINITE_NS,
    MAX_BLOCKING_NS,
    Durability,
    History,
    Qos,
    Reliability,
)

_RELIABILITY: tuple[Reliability, ...] = ("best_effort", "reliable")
_DURABILITY: tuple[Durability, ...] = ("volatile", "transient_local")
_HISTORY: tuple[History, ...] = ("keep_last", "keep_all")
_AUTOMATIC, _MANUAL_BY_TOPIC = 0, 2
_IGNORE_PARTICIPANT = 1
_XCDR1 = (ct.c_int16 * 1)(0)
_UNLIMITED = -1


@contextmanager
def policies(user_data: bytes) -> Iterator[int]:
    """Give the C library's object with nothing but user data, until the block ends."""
    library = loaded()
    made: int = library.dds_create_qos()
    try:
        library.dds_qset_userdata(made, user_data, len(user_data))
        yield made
    finally:
        library.dds_delete_qos(made)


@contextmanager
def endpoint_policies(
    qos: Qos, user_data: bytes, *, writer: bool, ignore_own: bool = False
) -> Iterator[int]:
    """Give the C library's object for an endpoint, until the block ends."""
    with policies(user_data) as made:
        library = loaded()
        _set_common(library, made, qos)
        if writer:
            _set_writer(library, made, qos)
        elif ignore_own:
            library.dds_qset_ignorelocal(made, _IGNORE_PARTICIPANT)
        yield made


def read_qos(source: int) -> Qos:
    """Return the policies of a discovered endpoint from the C library's object.

    DDS does not announce the history, except what a transient-local publisher keeps for those who
    come later (its durability service; the default, and that of peers that say nothing, is 1).
    """
    library = loaded()
    reliable, _ = _kind_and_time(library.dds_qget_reliability, source)
    liveliness, lease_ns = _kind_and_time(library.dds_qget_liveliness, source)
    kind = ct.c_int()
    kept = bool(library.dds_qget_durability(source, kind) and kind.value)
    keeps_all, depth = _durability_service(library, source) if kept else (False, 1)
    return Qos(
        reliability=_RELIABILITY[reliable > 0],
        durability=_DURABILITY[kept],
        depth=max(depth, 1),
        history=_HISTORY[keeps_all],
        deadline_ns=_time(library.dds_qget_deadline, source),
        lifespan_ns=_time(library.dds_qget_lifespan, source),
        liveliness="manual_by_topic" if liveliness == _MANUAL_BY_TOPIC else "automatic",
        lease_ns=lease_ns,
    )


def read_user_data(source: int) -> bytes:
    """Return the user data in the C library's object."""
    library, found, size = loaded(), ct.c_void_p(), ct.c_size_t()
    if not library.dds_qget_userdata(source, found, size) or not found.value:
        return b""
    try:
        return ct.string_at(found.value, size.value)
    finally:
        library.dds_free(found)


def _set_common(library: Library, made: int, qos: Qos) -> None:
    manual = qos.liveliness == "manual_by_topic"
    library.dds_qset_reliability(made, _RELIABILITY.index(qos.reliability), MAX_BLOCKING_NS)
    library.dds_qset_durability(made, _DURABILITY.index(qos.durability))
    library.dds_qset_history(made, _HISTORY.index(qos.history), qos.depth)
    kind = _MANUAL_BY_TOPIC if manual else _AUTOMATIC
    library.dds_qset_liveliness(made, kind, _duration(qos.lease_ns))
    library.dds_qset_deadline(made, _duration(qos.deadline_ns))
    library.dds_qset_data_representation(made, 1, _XCDR1)


def _set_writer(library: Library, made: int, qos: Qos) -> None:
    library.dds_qset_lifespan(made, _duration(qos.lifespan_ns))
    library.dds_qset_writer_data_lifecycle(made, False)
    if qos.durability == "transient_local":
        history = _HISTORY.index(qos.history)
        limits = (_UNLIMITED, _UNLIMITED, _UNLIMITED)
        library.dds_qset_durability_service(made, 0, history, qos.depth, *limits)


def _durability_service(library: Library, source: int) -> tuple[bool, int]:
    """Return whether a publisher keeps all, and how many samples it keeps otherwise."""
    cleanup, kind, depth, limit = DURATION(), ct.c_int(), ct.c_int32(1), ct.c_int32()
    library.dds_qget_durability_service(source, cleanup, kind, depth, limit, limit, limit)
    return bool(kind.value), depth.value


def _kind_and_time(get: Callable[..., bool], source: int) -> tuple[int, int | None]:
    kind, time = ct.c_int(), DURATION(INFINITE_NS)
    get(source, kind, time)
    return kind.value, _optional(time.value)


def _time(get: Callable[..., bool], source: int) -> int | None:
    time = DURATION(INFINITE_NS)
    get(source, time)
    return _optional(time.value)


def _duration(nanoseconds: int | None) -> int:
    return INFINITE_NS if nanoseconds is None else nanoseconds


def _optional(nanoseconds: int) -> int | None:
    return None if nanoseconds >= INFINITE_NS else nanoseconds
