# SPDX-License-Identifier: Apache-2.0
"""What must hold between parameters, beyond the range of each."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields
from itertools import pairwise
from math import radians
from typing import Any

from safety_island.control.limits import MAX_DELAY_STEPS, MAX_HISTORY, MAX_SHAPE_HISTORY
from safety_island.guard.params import GuardParams
from safety_island.parameter import key_of

Values = Mapping[str, Any]


@dataclass(frozen=True)
class Rule:
    """A condition on some keys: ``check`` returns what is wrong, or None; ``doc`` says it."""

    keys: tuple[str, ...]
    doc: str
    check: Callable[[Values], str | None]


ORDERED = (
    ("min_out", "max_out"),
    ("min_p_effort", "max_p_effort"),
    ("min_i_effort", "max_i_effort"),
    ("min_d_effort", "max_d_effort"),
    ("smooth_stop_min_strong_acc", "smooth_stop_max_strong_acc"),
    ("smooth_stop_strong_stop_dist", "smooth_stop_weak_stop_dist"),
    ("min_acc", "max_acc"),
    ("min_jerk", "max_jerk"),
    ("min_pitch_rad", "max_pitch_rad"),
    ("ctrl_period", "timeout_thr_sec"),
    ("ctrl_period", "guard.longest_step"),
    ("guard.shortest_step", "guard.longest_step"),
)
"""Pairs of which the first is at most the second."""

TABLES = (
    ("curvature_list_for_steer_rate_lim", "steer_rate_lim_dps_list_by_curvature"),
    ("velocity_list_for_steer_rate_lim", "steer_rate_lim_dps_list_by_velocity"),
)
"""Abscissae and values of the tables."""

GUARD_TABLES = tuple(
    ("guard.speed_points", key_of(item))
    for item in fields(GuardParams)
    if str(item.type).startswith("tuple") and item.name != "speed_points"
)
"""The same of the guard: all its limits stand over one list of speeds."""

FILTERS = ("steering_lpf_cutoff_hz", "error_deriv_lpf_cutoff_hz")

SPANS = (
    ("input_delay", MAX_DELAY_STEPS),
    ("delay_compensation_time", MAX_HISTORY - 4),
    ("new_traj_duration_time", MAX_SHAPE_HISTORY),
)
"""Times that are kept as that many control periods at most."""

DYNAMICS = tuple(
    f"vehicle.{name}" for name in ("mass_fl", "mass_fr", "mass_rl", "mass_rr", "cf", "cr")
)


def nyquist_hz(period: float) -> float:
    """Return the highest frequency that samples at this period [s] can show."""
    return 1.0 / (2.0 * period)


def _ordered(low: str, high: str) -> Rule:
    def check(values: Values) -> str | None:
        if values[low] <= values[high]:
            return None
        return f"found {low} {values[low]:g} above {high} {values[high]:g}; expected at most that"

    return Rule((low, high), f"`{low}` is at most `{high}`", check)


def _same_length(at: str, table: str) -> Rule:
    def check(values: Values) -> str | None:
        if len(values[at]) == len(values[table]):
            return None
        sizes = f"{len(values[at])} entries in {at} and {len(values[table])} in {table}"
        return f"found {sizes}; expected as many in both"

    return Rule((at, table), f"`{at}` and `{table}` are of one length", check)


def _ascending(at: str) -> Rule:
    def check(values: Values) -> str | None:
        numbers = values[at]
        if all(a < b for a, b in pairwise(numbers)):
            return None
        return f"found {list(numbers)}; expected each entry above the one before it"

    return Rule((at,), f"`{at}` ascends", check)


def above_nyquist(cutoff: str, values: Values) -> bool:
    """Tell whether a filter that is in use has a cutoff that its samples cannot show.

    The filter of the error rates is in use with the dynamics model only.
    """
    used = cutoff == "steering_lpf_cutoff_hz" or values["vehicle_model_type"] == "dynamics"
    return bool(used and values[cutoff] * 2.0 * values["ctrl_period"] >= 1.0)


def _below_nyquist(cutoff: str) -> Rule:
    def check(values: Values) -> str | None:
        if values["pass_filters_above_nyquist"] or not above_nyquist(cutoff, values):
            return None
        limit = nyquist_hz(values["ctrl_period"])
        return (
            f"found {cutoff} {values[cutoff]:g} Hz at ctrl_period {values['ctrl_period']:g} s;"
            f" expected below its Nyquist frequency of {limit:.4g} Hz, or"
            " pass_filters_above_nyquist: true to run without this filter"
        )

    keys = (cutoff, "ctrl_period", "vehicle_model_type", "pass_filters_above_nyquist")
    return Rule(keys, f"`{cutoff}` is below 1/(2 `ctrl_period`), where its filter is in use", check)


def _span(time: str, steps: int) -> Rule:
    def check(values: Values) -> str | None:
        period = values["ctrl_period"]
        if values[time] < (steps + 0.5) * period:
            return None
        return (
            f"found {time} {values[time]:g} s at ctrl_period {period:g} s;"
            f" expected at most {steps} periods, {steps * period:g} s"
        )

    return Rule((time, "ctrl_period"), f"`{time}` is at most {steps} periods", check)


def _loaded(key: str) -> Rule:
    def check(values: Values) -> str | None:
        if values["vehicle_model_type"] != "dynamics" or values[key] > 0.0:
            return None
        return f"found {key} {values[key]:g}; expected above 0 for vehicle_model_type dynamics"

    return Rule((key, "vehicle_model_type"), f"`{key}` is above 0 for the dynamics model", check)


def _stop_distances(values: Values) -> str | None:
    leave = values["drive_state_stop_dist"] + values["drive_state_offset_stop_dist"]
    if values["stopping_state_stop_dist"] <= leave:
        return None
    return (
        f"found stopping_state_stop_dist {values['stopping_state_stop_dist']:g} m; expected at most"
        f" drive_state_stop_dist + drive_state_offset_stop_dist, {leave:g} m,"
        " or STOPPING and DRIVE alternate"
    )


_STOP = ("stopping_state_stop_dist", "drive_state_stop_dist", "drive_state_offset_stop_dist")

RULES: tuple[Rule, ...] = (
    *(_ordered(low, high) for low, high in ORDERED),
    *(_same_length(at, table) for at, table in (*TABLES, *GUARD_TABLES)),
    *(_ascending(at) for at in (*(at for at, _ in TABLES), "guard.speed_points")),
    *(_below_nyquist(cutoff) for cutoff in FILTERS),
    *(_span(time, steps) for time, steps in SPANS),
    *(_loaded(key) for key in DYNAMICS),
    Rule(_STOP, f"`{_STOP[0]}` is at most `{_STOP[1]}` + `{_STOP[2]}`", _stop_distances),
)


def inconsistencies(values: Values) -> Iterable[tuple[Rule, str]]:
    """Yield each rule that the values break, with what is wrong.

    A rule with a key that is missing from the values is left out: that key has its own error.
    """
    for rule in RULES:
        if all(key in values for key in rule.keys):
            text = rule.check(values)
            if text is not None:
                yield rule, text


@dataclass(frozen=True)
class Stricter:
    """A limit of the guard, and the value of a controller's parameter that it should let through.

    ``scale`` takes that parameter to the unit and sign of the limit.
    """

    limit: str
    key: str
    scale: float = 1.0

    def note(self, values: Values) -> str | None:
        """Say that the limit is below the parameter at every speed; None when it is not."""
        limit, value = _largest(values[self.limit]), _largest(values[self.key], self.scale)
        if limit >= value:
            return None
        return (
            f"{self.limit} is {limit:g} at most, stricter than {self.key}, which allows {value:g}:"
            " the guard clamps commands that the controllers may give"
        )


STRICTER = (
    Stricter("guard.steering_angle", "max_steer_angle"),
    Stricter("guard.steering_rate", "steer_rate_lim_dps_list_by_curvature", radians(1.0)),
    Stricter("guard.steering_rate", "steer_rate_lim_dps_list_by_velocity", radians(1.0)),
    Stricter("guard.acceleration", "max_acc"),
    Stricter("guard.deceleration", "min_acc", -1.0),
    Stricter("guard.deceleration", "stopped_acc", -1.0),
    Stricter("guard.jerk", "max_acc_cmd_diff"),
    Stricter("guard.brake_jerk", "max_acc_cmd_diff"),
)
"""What bounds the controllers' commands, beside the limit of the guard on the same quantity."""


def _largest(value: Any, scale: float = 1.0) -> float:
    numbers: tuple[float, ...] = value if isinstance(value, tuple) else (value,)
    return max(number * scale for number in numbers)


def notes(values: Values) -> list[str]:
    """Return what a start should say once: filters that do nothing, a guard that is stricter."""
    limit = nyquist_hz(values["ctrl_period"])
    passed_through = [
        f"{cutoff} {values[cutoff]:g} Hz is not below the Nyquist frequency of {limit:.4g} Hz:"
        " this filter passes its input through"
        for cutoff in FILTERS
        if above_nyquist(cutoff, values)
    ]
    return passed_through + [note for item in STRICTER if (note := item.note(values))]
