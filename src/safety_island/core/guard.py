# SPDX-License-Identifier: Apache-2.0
"""The guard, compiled from outside, and what Python calls it by."""

from __future__ import annotations

from dataclasses import fields
from struct import Struct
from typing import Any, NamedTuple

import numpy as np

from safety_island.guard import GuardParams, Verdict, guard
from safety_island.guard import records as columns
from safety_island.kernel.kernel import compile_from_outside, entry
from safety_island.kernel.records import Records, record

GUARD_PARAMS = record(columns.PARAMETERS)
GUARD_STATE = record(columns.STATE)
GUARD_PROPOSAL = record(columns.PROPOSAL)
GUARD_DECISION = record(columns.DECISION)

compile_from_outside(guard)
guard_command = entry(GUARD_PARAMS, GUARD_STATE, GUARD_PROPOSAL, GUARD_DECISION, records=globals())(
    guard.guard_command
)
guard_take_back = entry(GUARD_STATE, records=globals())(guard.guard_take_back)
guard_forget = entry(GUARD_STATE, records=globals())(guard.guard_forget)

_VERDICTS = {int(verdict): verdict for verdict in Verdict}


def _layout(dtype: Any) -> Struct:
    """Return the C structure of a record without arrays."""
    return Struct("@" + "".join(dtype.fields[name][0].char for name in dtype.names))


_PROPOSAL, _DECISION = _layout(GUARD_PROPOSAL), _layout(GUARD_DECISION)


def pack_guard(limits: GuardParams, wheel_base: float, timeout_s: float) -> Records:
    """Return the (1,) record of the guard's parameters; wheelbase [m], age limit [s].

    Raises ValueError when the lists have not as many entries each, none, or too many.
    """
    sizes = {name: len(getattr(limits, name)) for name in columns.LISTS}
    count = sizes["speed_points"]
    if set(sizes.values()) != {count} or not 1 <= count <= columns.MAX_SPEED_POINTS:
        found = ", ".join(f"{size} in {name}" for name, size in sizes.items())
        raise ValueError(
            f"the guard's lists: found {found} entries; expected as many in each,"
            f" 1 to {columns.MAX_SPEED_POINTS}"
        )
    packed = np.zeros(1, GUARD_PARAMS)
    for item in fields(GuardParams):
        value = getattr(limits, item.name)
        if item.name in columns.LISTS:
            packed[item.name][0, :count] = value
        else:
            packed[item.name] = value
    packed["points"], packed["wheel_base"], packed["timeout"] = count, wheel_base, timeout_s
    return packed


class Proposal(NamedTuple):
    """A command as the controllers want to send it.

    The acceleration is that along the direction of driving: below zero it brakes, in reverse too.
    """

    now: float  # monotonic [s]
    stamp: float  # monotonic stamp of the older half of the command [s]
    sequence: int  # number of this command, must rise
    steering_tire_angle: float  # [rad]
    steering_tire_rotation_rate: float  # [rad/s]
    velocity: float  # [m/s]
    acceleration: float  # [m/s^2]


class Decision(NamedTuple):
    """What may be sent; of a refused command every value is NaN, for there is none to send."""

    verdict: Verdict
    limits: int  # bits of Limit
    steering_tire_angle: float  # [rad]
    steering_tire_rotation_rate: float  # [rad/s]
    velocity: float  # [m/s]
    acceleration: float  # [m/s^2]


class Guard:
    """Stands between the controllers and the outputs and shares no code with what it checks.

    ``state`` is all its memory, a record of shape (1,).
    """

    def __init__(self, limits: GuardParams, wheel_base: float, timeout_s: float) -> None:
        """Take the limits, the wheelbase [m] and the age [s] beyond which a command is stale."""
        self.state: Records = np.zeros(1, GUARD_STATE)
        params = pack_guard(limits, wheel_base, timeout_s)
        proposal, decision = np.zeros(1, GUARD_PROPOSAL), np.zeros(1, GUARD_DECISION)
        self._asked: Any = proposal.view(np.uint8).data
        self._answer: Any = decision.view(np.uint8).data
        self._check = guard_command.bind(params, self.state, proposal, decision)
        self._take_back = guard_take_back.bind(self.state)
        self._forget = guard_forget.bind(self.state)

    def check(
        self, proposal: Proposal, speed: float, steering: float, engaged: bool = True
    ) -> Decision:
        """Decide on a command, and remember it when it may be sent.

        ``speed`` [m/s] and ``steering`` [rad] are measured. While nobody follows the commands
        (``engaged`` False) their distance from the measured steering says nothing, and is let be.
        """
        _PROPOSAL.pack_into(self._asked, 0, *proposal, speed, steering, engaged)
        verdict = _VERDICTS[self._check()]
        return Decision(verdict, *_DECISION.unpack_from(self._answer)[1:])

    def take_back(self) -> None:
        """Undo the last check, for its command was not sent; its number stays used."""
        self._take_back()

    def forget(self) -> None:
        """Let the next command have no predecessor, as after a silence; its number must rise."""
        self._forget()
