# SPDX-License-Identifier: Apache-2.0
"""What changed in Autoware's trajectory follower from release to release, as records of rules.

One table holds it: each release names the rules that it changed, and takes the rest from the one
before. The rules of a release become columns of ``PARAMS``; a kernel asks for a rule by its name
and knows no release.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from safety_island.parameter import parameter

RELEASES = tuple(f"0.{minor}" for minor in range(40, 54))
"""Releases of autoware_universe that the controllers can follow, oldest first."""


def _rule(doc: str) -> bool:
    rule: bool = parameter("", doc)
    return rule


@dataclass(frozen=True)
class Rules:
    """The rules of one release. ``Autoware`` names the change in its changelog."""

    stopped_look_ahead: float = parameter(
        "m", "The steering may be held when the slowest speed within this distance is 0 (9690)."
    )
    threshold_counts_as_stopped: bool = _rule(
        "A speed equal to stop_state_entry_ego_speed counts as stopped (9690)."
    )
    history_exceeds_second: bool = _rule(
        "Steering commands are forgotten when older than 1 s; else from 1 s on, as the firmware has"
        " it."
    )
    whole_nanoseconds: bool = _rule(
        "Times since an event are compared in whole nanoseconds; else as differences of doubles."
    )
    counts_from_start: bool = _rule(
        "A vehicle at rest counts as stopped from the start; else only once it has moved."
    )
    stop_distance_from_ego: bool = _rule(
        "The stopping distance counts from the ego itself, also beyond the end; else from its"
        " projection (9684)."
    )
    slope_rate_limited: bool = _rule(
        "The slope of the adaptive sources changes at the rate of the jerk limits (9656, 9705)."
    )
    drive_resets_raw: bool = _rule(
        "STOPPING to DRIVE resets the raw acceleration; else the last output (10684)."
    )
    feedback_turns_in_reverse: bool = _rule(
        "The measured acceleration counts in the direction of the gear (10822)."
    )
    stopped_in_manual: bool = _rule("STOPPED holds while not under control and at rest (11369).")
    stopped_adds_slope: bool = _rule("STOPPED brakes by the pull of the slope more (12007).")
    steering_offset_is_input: bool = _rule(
        "The steering offset comes from a topic; else it is estimated (12004, 12301)."
    )
    slope_turns_in_reverse: bool = _rule(
        "The trajectory's pitch is positive when body x points uphill; else in the direction of"
        " travel (13247)."
    )
    speeds_by_time: bool = _rule(
        "Smooth stop looks at the speeds of the delay time, the present one included; else at a"
        " number of earlier ones (12983)."
    )
    one_sided_ends: bool = _rule(
        "Yaw at the ends of the reference is that of the end segment, and points too close together"
        " repeat yaw and curvature of the one before; else the ends are copied (12886)."
    )
    extends_with_end_speed: bool = _rule(
        "The terminal extension has the speed of the last point; else 10 m/s."
    )
    double_command_history: bool = _rule(
        "The history of acceleration commands keeps doubles; else single precision."
    )


_FIRST = Rules(
    stopped_look_ahead=0.0,
    threshold_counts_as_stopped=False,
    history_exceeds_second=False,
    whole_nanoseconds=False,
    counts_from_start=False,
    stop_distance_from_ego=False,
    slope_rate_limited=False,
    drive_resets_raw=False,
    feedback_turns_in_reverse=False,
    stopped_in_manual=False,
    stopped_adds_slope=False,
    steering_offset_is_input=False,
    slope_turns_in_reverse=False,
    speeds_by_time=False,
    one_sided_ends=False,
    extends_with_end_speed=False,
    double_command_history=False,
)
"""Release 0.40 as the C++ firmware runs it."""

CHANGES: dict[str, dict[str, bool | float]] = {
    "0.41": {
        "stopped_look_ahead": 1.0,
        "threshold_counts_as_stopped": True,
        "history_exceeds_second": True,
        "whole_nanoseconds": True,
        "counts_from_start": True,
        "stop_distance_from_ego": True,
        "slope_rate_limited": True,
    },
    "0.46": {"drive_resets_raw": True, "feedback_turns_in_reverse": True},
    "0.48": {"stopped_in_manual": True},
    "0.51": {"stopped_adds_slope": True, "steering_offset_is_input": True},
    "0.53": {
        "slope_turns_in_reverse": True,
        "speeds_by_time": True,
        "one_sided_ends": True,
        "extends_with_end_speed": True,
        "double_command_history": True,
    },
}
"""Release -> the rules that it changed."""


def rules_of(release: str) -> Rules:
    """Return the rules of a release.

    Raises ValueError for one that is not in RELEASES.
    """
    last = RELEASES.index(release)
    rules = _FIRST
    for since, changed in CHANGES.items():
        if RELEASES.index(since) <= last:
            rules = replace(rules, **changed)  # type: ignore[arg-type]
    return rules
