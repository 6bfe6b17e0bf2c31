# SPDX-License-Identifier: Apache-2.0
"""Faults on purpose: what a test or a campaign does to a live domain."""

from __future__ import annotations

import ctypes as ct
from typing import Any

from cyclonedds.internal import DDS

from safety_island.dds.errors import DdsError
from safety_island.dds.participant import Participant

_library: Any = DDS._dll_handle
_set_deaf_mute = ct.CFUNCTYPE(ct.c_int32, ct.c_int32, ct.c_bool, ct.c_bool, ct.c_int64)(
    ("dds_domain_set_deafmute", _library)
)


def isolate(participant: Participant, duration_s: float) -> None:
    """Cut the participant's whole domain in this process off the network for a while.

    Nothing is sent or received for ``duration_s`` [s]; then all goes on by itself. Participants of
    the same process still hear each other.
    """
    code = _set_deaf_mute(participant.handle, True, True, round(duration_s * 1e9))
    if code < 0:
        raise DdsError(f"domain {participant.domain_id} cannot be cut off ({code})")
