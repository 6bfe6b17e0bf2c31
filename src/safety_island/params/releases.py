# SPDX-License-Identifier: Apache-2.0
"""Which key of Autoware's files belongs to which releases, and what became of older keys.

Sources: the tags of autoware_launch, and the history of the files in public repositories.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from safety_island.control.release import RELEASES
from safety_island.params.schema import KNOWN
from safety_island.params.tree import Entry

RELEASE = "autoware_release"
"""The key that names the release, whatever the files hold."""


@dataclass(frozen=True)
class Span:
    """The first and the last release whose files hold a key; None: no such bound."""

    first: str | None = None
    last: str | None = None

    def __str__(self) -> str:
        if self.first is None:
            return f"until {self.last}"
        return f"since {self.first}" if self.last is None else f"{self.first} to {self.last}"

    def holds(self, release: str) -> bool:
        """Whether files of a release hold the key."""
        at = RELEASES.index(release)
        after = self.first is None or at >= RELEASES.index(self.first)
        return after and (self.last is None or at <= RELEASES.index(self.last))


_UNTIL_040, _UNTIL_050 = Span(last="0.40"), Span(last="0.50")
_SINCE_051, _SINCE_053 = Span(first="0.51"), Span(first="0.53")

SPANS: dict[str, Span] = {
    "admissible_position_error": _UNTIL_040,
    "admissible_yaw_error_rad": _UNTIL_040,
    "emergency_state_traj_trans_dev": _UNTIL_040,
    "emergency_state_traj_rot_dev": _UNTIL_040,
    "acceleration_limit": _UNTIL_050,
    "velocity_time_constant": _UNTIL_050,
    "steering_offset.update_vel_threshold": _UNTIL_050,
    "steering_offset.update_steer_threshold": _UNTIL_050,
    "steering_offset.average_num": _UNTIL_050,
    "steering_offset.steering_offset_limit": _UNTIL_050,
    "steering_offset.steer_offset_filter_cutoff_hz": _SINCE_051,
    "steering_offset.max_update_th": _SINCE_051,
    "ff_scale_min": _SINCE_051,
    "ff_scale_max": _SINCE_051,
    "cyclic_message_timeout_thr_sec": _SINCE_051,
    "trajectory_reference_mode": _SINCE_053,
}
"""Keys that not every release has. All others are in the files of all releases since 0.40."""

OWN_KEYS = (
    RELEASE,
    "enable_deviation_checks",
    "steering_offset.input_limit",
    "symmetric_steer_rate_limits",
    "pass_filters_above_nyquist",
    "correct_reverse_signs",
)
"""Keys of the controllers that no file of Autoware holds."""

_WHOLE = 0.6
"""Share of the keys of a controller from which on a file counts as whole, so that a key that is not
in it tells as much as one that is."""


@dataclass(frozen=True)
class Decision:
    """The release that the keys of files stand for, and the key that shows it."""

    release: str
    why: str
    entry: Entry | None = None


def decide(entries: Sequence[Entry]) -> Decision | None:
    """Return the release of a set of files, taken together; None when their keys fit several.

    By the first rule that applies: a key of a newer release, a key that ended with 0.40, a value
    that 0.40 does not know, a whole file without the keys that ended with 0.40.
    """
    by_key = {entry.key: entry for entry in entries}
    spans = [(SPANS[key], entry) for key, entry in by_key.items() if key in SPANS]
    for span in (_SINCE_053, _SINCE_051):
        for found, entry in spans:
            if found == span and found.first is not None:
                newest = _newest(found.first)
                return Decision(newest, f"'{entry.key}' is there since {found.first}", entry)
    for found, entry in spans:
        if found == _UNTIL_040:
            return Decision("0.40", f"'{entry.key}' ended with 0.40", entry)
    source = by_key.get("slope_source")
    if source is not None and source.value == "trajectory_goal_adaptive":
        return Decision("0.50", f"'{source.key}: {source.value}' is there since 0.41", source)
    if any(_is_whole(by_key, group) for group in ("lateral", "longitudinal")):
        return Decision("0.50", "a whole file without the deviation limits that ended with 0.40")
    return None


def _newest(first: str) -> str:
    """The newest release whose files look like those of ``first``: bugs were mended on the way."""
    later = [span.first for span in SPANS.values() if span.first is not None]
    ends = [RELEASES.index(name) for name in later if RELEASES.index(name) > RELEASES.index(first)]
    return RELEASES[min(ends) - 1] if ends else RELEASES[-1]


def _is_whole(keys: Mapping[str, Entry], group: str) -> bool:
    """Whether the files hold most of the keys that each release has for a controller."""
    common = [
        known.key
        for known in KNOWN.values()
        if known.group == group
        and known.key not in SPANS
        and known.key not in OWN_KEYS
        and not known.key.startswith("vehicle.")
    ]
    return sum(key in keys for key in common) >= _WHOLE * len(common)


@dataclass(frozen=True)
class Former:
    """A key of older files: what replaces it, since when, and how its value reads today.

    ``today`` returns the values by today's keys; None: there is no such value to give.
    """

    replaced_by: str
    since: str
    today: Callable[[Any], Mapping[str, object]] | None = None


def _slope_source(value: Any) -> Mapping[str, object]:
    return {"slope_source": "trajectory_pitch" if value is True else "raw_pitch"}


def _rate_limit(value: Any) -> Mapping[str, object]:
    return {
        "steer_rate_lim_dps_list_by_curvature": [value],
        "curvature_list_for_steer_rate_lim": [0.0],
        "steer_rate_lim_dps_list_by_velocity": [value],
        "velocity_list_for_steer_rate_lim": [0.0],
    }


def _curvature(value: Any) -> Mapping[str, object]:
    return {"curvature_smoothing_num_traj": value, "curvature_smoothing_num_ref_steer": value}


FORMER: dict[str, Former] = {
    "use_trajectory_for_pitch_calculation": Former(
        "slope_source (raw_pitch for false, trajectory_pitch for true)", "late 2023", _slope_source
    ),
    "steer_rate_lim_dps": Former(
        "steer_rate_lim_dps_list_by_curvature and _by_velocity, with their lists of curvature and"
        " speed",
        "2022",
        _rate_limit,
    ),
    "curvature_smoothing_num": Former(
        "curvature_smoothing_num_traj and curvature_smoothing_num_ref_steer", "2021", _curvature
    ),
    "admisible_position_error": Former(
        "admissible_position_error", "2021", lambda v: {"admissible_position_error": v}
    ),
    "admisible_yaw_error_rad": Former(
        "admissible_yaw_error_rad", "2021", lambda v: {"admissible_yaw_error_rad": v}
    ),
    "admisible_yaw_error_deg": Former("admissible_yaw_error_rad, in radians", "2021"),
    "admissible_yaw_error_deg": Former("admissible_yaw_error_rad, in radians", "2021"),
    "admissible_yaw_error": Former("admissible_yaw_error_rad", "2021"),
    "ctrl_period_s": Former("ctrl_period", "2021"),
    "control_rate": Former("ctrl_period, in seconds", "2021"),
    "emergency_state_traj_lat_dev": Former("emergency_state_traj_trans_dev", "2021"),
    "closest_waypoint_distance_threshold": Former("ego_nearest_dist_threshold", "2022"),
    "closest_waypoint_angle_threshold": Former("ego_nearest_yaw_threshold, in radians", "2022"),
}
"""Keys of files before 0.40 that have another name or form today."""

FOREIGN: dict[str, str] = dict.fromkeys(
    (
        "velocity_thresholds",
        "enable_velocity_lookahead_feedback",
        "velocity_lookahead_time",
        "velocity_lookahead_blend_weight",
        "enable_emergency_exit_without_stop",
    ),
    "belongs to branches of TIER IV, to no release of Autoware; take it out: the controllers do not"
    " have what it sets",
)
"""Keys that would change the controllers and are in no release, with what to say."""
