# SPDX-License-Identifier: Apache-2.0
"""The only place that touches the private C layer of cyclonedds: what discovery found.

``cyclonedds._clayer`` is not an API: it may change with any release. Hence the exact pin, and
``tests/dds/test_binding.py``, which fails when what is used here behaves differently.
"""

from __future__ import annotations

from importlib.metadata import version
from typing import Any, NamedTuple

from cyclonedds import _clayer
from cyclonedds.builtin_types import cqos_to_qos
from cyclonedds.core import Entity, InstanceState, SampleState, ViewState

from safety_island.dds.errors import DdsError

PINNED_VERSION = "11.0.1"
ANY = SampleState.Any | ViewState.Any | InstanceState.Any

_convert_qos: Any = cqos_to_qos

RETCODE_BAD_PARAMETER = -3
RETCODE_TIMEOUT = -10


class RawSample(NamedTuple):
    """One taken sample; without ``valid`` it only tells that an instance or a writer went away."""

    data: bytes
    valid: bool
    source_timestamp_ns: int
    publication_handle: int
    state: int = InstanceState.Alive
    """What became of the topic's instance by now: an ``InstanceState``."""

    @property
    def is_alive(self) -> bool:
        """Whether what was said last still counts."""
        return self.state == InstanceState.Alive

    @property
    def is_disposed(self) -> bool:
        """Whether a publisher has disposed what was said last."""
        return self.state == InstanceState.NotAliveDisposed

    @property
    def is_orphaned(self) -> bool:
        """Whether none of those who published is alive any more."""
        return self.state == InstanceState.NotAliveNoWriters


class RawEndpoint(NamedTuple):
    """One event of discovery: an endpoint that appeared or changed, or (not ``alive``) left."""

    guid: bytes
    participant: bytes
    topic: str
    type_name: str
    qos: Any
    alive: bool
    handle: int = 0
    """The ``publication_handle`` of its samples."""
    lives: int = 0
    """How often it had left before, as far as the library remembers."""


def check_version() -> None:
    """Raise DdsError unless the installed cyclonedds is the one that this module was made for."""
    found = version("cyclonedds")
    if found != PINNED_VERSION:
        raise DdsError(
            f"found cyclonedds {found}, expected exactly {PINNED_VERSION};"
            f" run: pip install cyclonedds=={PINNED_VERSION}"
        )


def matched_writer(reader: int, handle: int) -> bytes | None:
    """Return the GUID (16 bytes) of a writer that the reader is matched with, by its handle."""
    found = _clayer.ddspy_get_matched_publication_data(reader, handle, _key_of_endpoint, _no_qos)
    return found if isinstance(found, bytes) else None


def take_endpoints(reader: int, limit: int) -> list[RawEndpoint]:
    """Take up to ``limit`` events of a discovery reader, oldest first."""
    found = _clayer.ddspy_take_endpoint(reader, limit, _endpoint, _qos_or_none)
    if isinstance(found, int):
        raise DdsError(f"reading discovery failed: {strerror(found)}")
    events: list[RawEndpoint] = found
    return events


def delete(entity: Entity) -> None:
    """Delete a DDS entity and everything below it, now; a second time does nothing."""
    known: Any = Entity._entities
    if known.pop(entity._ref, None) is not None:
        entity._delete(entity._ref)


def strerror(code: int) -> str:
    """Return a return code of the library in words."""
    words = {
        -1: "error",
        -3: "bad parameter (not CDR of this type)",
        -4: "precondition not met",
        -5: "out of resources",
        -9: "already deleted",
        RETCODE_TIMEOUT: "timed out",
    }
    return f"{words.get(code, 'failed')} ({code})"


def _endpoint(
    key: bytes,
    participant: bytes,
    _handle: int,
    topic: str | None,
    type_name: str | None,
    qos: Any,
    info: Any,
    _type_id: bytes | None,
) -> RawEndpoint:
    alive = info.valid_data and info.instance_state == InstanceState.Alive
    return RawEndpoint(
        key,
        participant,
        topic or "",
        type_name or "",
        qos,
        alive,
        info.instance_handle,
        info.disposed_generation_count,
    )


def _qos_or_none(pointer: int) -> Any:
    """Convert the QoS of a peer; what the library cannot convert must not stop discovery."""
    try:
        return _convert_qos(pointer)
    except Exception:
        return None


def _key_of_endpoint(key: bytes, *_: object) -> bytes:
    return key


def _no_qos(_: int) -> None:
    return None
