# SPDX-License-Identifier: Apache-2.0
"""The states of the island."""

from __future__ import annotations

from enum import IntEnum, IntFlag


class State(IntEnum):
    """What the island lets out; the numbers are those of the status message."""

    INIT = 0
    """Not everything that is needed is there: nothing is sent."""
    READY = 1
    """Commands are sent; the vehicle is not under their control."""
    ACTIVE = 2
    """Commands are sent and drive the vehicle."""
    HOLD = 3
    """CAN_ONLY: the last good command is repeated, for some ticks at most."""
    STOP = 4
    """CAN_ONLY: the declared stop ramp is sent."""
    SILENT = 5
    """Nothing is sent, until the island is armed again."""


class LifeFlag(IntFlag):
    """What else follows from the state of the life cycle: the bits that ``life_flags`` returns."""

    CONTROLS = 1
    """The controllers may count on being followed."""
    ARMED = 2
    """The vehicle is under control, or may be again without being engaged anew."""
    MUST_STOP = 4
    """Commands may not just end: the vehicle must be stopped first."""
