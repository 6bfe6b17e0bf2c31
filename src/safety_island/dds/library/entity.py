# SPDX-License-Identifier: Apache-2.0
"""Entities of the C library: numbers that its functions take."""

from __future__ import annotations

import ctypes as ct

from safety_island.dds.errors import DdsError
from safety_island.dds.library.layouts import HANDLE, Guid
from safety_island.dds.library.loading import loaded

RETCODE_ERROR = -1
RETCODE_BAD_PARAMETER = -3
RETCODE_TIMEOUT = -10
_WORDS = {
    RETCODE_ERROR: "error",
    RETCODE_BAD_PARAMETER: "bad parameter (not CDR of this type)",
    -4: "precondition not met",
    -5: "out of resources",
    -9: "already deleted",
    RETCODE_TIMEOUT: "timed out",
}


def strerror(code: int) -> str:
    """Return a return code of the library in words."""
    return f"{_WORDS.get(code, 'failed')} ({code})"


def checked(code: int, what: str) -> int:
    """Return a result of the library; raise DdsError with what failed when it is an error."""
    if code < 0:
        raise DdsError(f"{what}: {strerror(code)}")
    return code


def delete(entity: int) -> None:
    """Delete an entity and everything below it, now; a second time does nothing."""
    loaded().dds_delete(entity)


def guid_of(entity: int) -> bytes:
    """Return the GUID of an entity, 16 bytes."""
    found = Guid()
    checked(loaded().dds_get_guid(entity, found), "an entity has no GUID")
    return bytes(found.bytes)


def handle_of(entity: int) -> int:
    """Return the number by which samples and discovery name an entity."""
    found = HANDLE()
    checked(loaded().dds_get_instance_handle(entity, ct.byref(found)), "an entity has no handle")
    return found.value
