# SPDX-License-Identifier: Apache-2.0
"""Faults on purpose: what a test or a campaign does to a live domain."""

from __future__ import annotations

from safety_island.dds.library.entity import checked
from safety_island.dds.library.loading import loaded
from safety_island.dds.participant import Participant


def isolate(participant: Participant, duration_s: float) -> None:
    """Cut the participant's whole domain in this process off the network for a while.

    Nothing is sent or received for ``duration_s`` [s]; then all goes on by itself. Participants of
    the same process still hear each other.
    """
    code = loaded().dds_domain_set_deafmute(participant.handle, True, True, round(duration_s * 1e9))
    checked(code, f"domain {participant.domain_id} cannot be cut off")
