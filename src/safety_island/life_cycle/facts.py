# SPDX-License-Identifier: Apache-2.0
"""What a tick found out, as the life cycle is told it."""

from __future__ import annotations

from typing import NamedTuple

from safety_island.life_cycle.reason import Reason


class Facts(NamedTuple):
    """What a tick found out; speed in m/s."""

    blocked: Reason
    """What the inputs and the other publishers forbid, NONE when nothing."""
    disengaged: Reason
    """Why the vehicle is not under control, NONE when it is."""
    speed: float
    arm: bool = False
    """Somebody asked to arm the island."""
    failed: bool = False
    """The controllers ended with an exception."""
    unsolved: bool = False
    """The MPC found no steering angle."""
    refused: Reason = Reason.NONE
    """Why the command must not go out."""
    unfollowable: bool = False
    """Trajectories come, but they are refused, or lead where the vehicle is not."""
