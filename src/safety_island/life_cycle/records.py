# SPDX-License-Identifier: Apache-2.0
"""Record types of the life cycle: parameters, what one tick found out, a command, all memory."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np

from safety_island.errors import ConfigurationError
from safety_island.kernel.records import Records, record
from safety_island.life_cycle.limits import MAX_OVERRUN_WINDOW, MAX_PUBLISHERS
from safety_island.life_cycle.params import LifeCycleParams, StopSteering

_SCALARS = {"float": "f8", "int": "i8", "str": "i8"}

LIFE_PARAMS = record(
    [
        *((item.name, _SCALARS[str(item.type)]) for item in fields(LifeCycleParams)),
        ("period_s", "f8"),  # of the ticks [s]
        ("has_ramp", "?"),  # the vehicle receives only CAN: nobody else could brake it
    ]
)
"""Every parameter of LifeCycleParams by its name; ``stop_steering`` is a StopSteering."""

FACTS_COLUMNS: list[Any] = [
    ("blocked", "i8"),  # Reason
    ("disengaged", "i8"),  # Reason
    ("speed", "f8"),  # [m/s]
    ("arm", "?"),
    ("failed", "?"),
    ("unsolved", "?"),
    ("refused", "i8"),  # Reason
    ("unfollowable", "?"),
]
FACTS = record(FACTS_COLUMNS)
"""What one tick found out: the fields of ``facts.Facts``, in its order."""

MOTION = record(
    [
        ("angle", "f8"),  # of the tyres [rad]
        ("rate", "f8"),  # of that angle [rad/s]
        ("velocity", "f8"),  # [m/s]
        ("acceleration", "f8"),  # [m/s^2]
    ]
)
"""A command: the fields of ``ramp.Motion``, in its order."""

LIFE = record(
    [
        ("state", "i8"),  # State
        ("reason", "i8"),  # Reason
        ("cause", "i8"),  # Reason
    ]
)
"""The fields of ``transition.Life``, in its order."""

STREAK = record(
    [
        ("count", "i8"),  # failures in a row
        ("since", "f8"),  # the first of them, monotonic [s]; says nothing when there is none
    ]
)

FAILURES = record(
    [
        ("faults", STREAK),  # of the controllers
        ("unsolved", STREAK),  # the MPC found no steering angle
        ("refusals", STREAK),  # of the guard
        ("outputs", STREAK),  # no output could take the command
        ("crashes", "i8"),  # ticks in a row that ended with an exception
        ("has_crashed", "?"),  # the last tick did
    ]
)

OVERRUN = record(
    [
        ("in_row", "i8"),  # late ticks in a row
        ("degraded_for", "i8"),  # ticks in a row
        ("degraded", "?"),  # late ticks in a row, or the mean period is too long
        ("over", "?"),  # that has gone on for too many ticks: the output must end
        ("n", "i8"),  # times that are known
        ("next", "i8"),  # where the next one goes; when all are known, the oldest is there
        ("times", "f8", (MAX_OVERRUN_WINDOW + 1,)),  # of the last ticks, monotonic [s]
    ]
)

RAMP = record(
    [
        ("has_begun", "?"),
        ("is_over", "?"),
        ("gear", "f8"),  # 1 forward, -1 backward
        ("speed", "f8"),  # along the gear [m/s]
        ("acceleration", "f8"),  # along the gear [m/s^2]
        ("angle", "f8"),  # of the tyres [rad]
        ("held_s", "f8"),  # at standstill [s]
    ]
)

STOP_MEMORY = record(
    [
        ("last_sent", MOTION),  # of the controllers
        ("holds", "i8"),  # periods for which it was repeated
        ("ramp", RAMP),
    ]
)

GUID = record([("first", "u8"), ("last", "u8")])
"""The 16 bytes that DDS names a publisher by; they are only compared."""

PUBLISHERS = record(
    [
        ("n", "i8"),  # how many there are, also when the table holds fewer
        ("guids", GUID, (MAX_PUBLISHERS,)),
    ]
)
"""A set of publishers."""

ISLANDS = record(
    [
        ("ready_at", "f8"),  # until then it looks for others [s]
        ("has_looked", "?"),
        ("assumes_earlier", "?"),  # more lived than the table holds: one may be the earlier one
        ("others", PUBLISHERS),  # of the command, beside ours
        ("earlier", PUBLISHERS),  # those that were there before us, and still live
    ]
)

LIFE_STATE = record(
    [
        ("life", LIFE),
        ("has_ticked", "?"),
        ("only_path", "?"),  # since ACTIVE nothing was lost but a trajectory, at standstill
        ("barred", "i8"),  # Reason why it must not arm itself while the vehicle moves
        ("last_tick", "f8"),  # monotonic [s]
        ("last_sleep_s", "f8"),  # how long the machine had slept in all [s]
        ("step_s", "f8"),  # from the tick before to this one [s]
        ("speed", "f8"),  # that was measured last [m/s]
        ("failures", FAILURES),
        ("overrun", OVERRUN),
        ("stop", STOP_MEMORY),
        ("islands", ISLANDS),
    ]
)
"""All memory of the life cycle: copying its bytes is a snapshot, writing them back a restore."""


def pack_life_params(params: LifeCycleParams, period_s: float, has_ramp: bool) -> Records:
    """Return the (1,) record of the parameters.

    Raises ConfigurationError for a window that the memory has no place for, which the loader of
    parameter files refuses as well.
    """
    if params.overrun_window > MAX_OVERRUN_WINDOW:
        raise ConfigurationError(
            f"life_cycle.overrun_window is {params.overrun_window}, "
            f"expected at most {MAX_OVERRUN_WINDOW}"
        )
    values = vars(params) | {"stop_steering": StopSteering[params.stop_steering.upper()]}
    packed = np.zeros(1, LIFE_PARAMS)
    for name, value in (values | {"period_s": period_s, "has_ramp": has_ramp}).items():
        packed[0][name] = value
    return packed
