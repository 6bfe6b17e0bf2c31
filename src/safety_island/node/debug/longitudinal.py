# SPDX-License-Identifier: Apache-2.0
"""The numbers of the topic longitudinal_diagnostic. Autoware: DebugValues of the PID controller."""

from __future__ import annotations

import math
from enum import IntEnum

import numpy as np
import numpy.typing as npt

from safety_island.control.release import RELEASES
from safety_island.control.slope import body_pitch
from safety_island.control.status import LongitudinalState, ReferenceMode
from safety_island.control.trajectory_walk import pitch_ahead
from safety_island.node.debug.follower import ObservedFollower
from safety_island.node.debug.lateral import temporal_values

_TELLS_PITCH_IN_USE = RELEASES.index("0.41")
_TELLS_TEMPORAL = RELEASES.index("0.53")


class Number(IntEnum):
    """Places in the array."""

    DT = 0
    CURRENT_VEL = 1
    TARGET_VEL = 2
    TARGET_ACC = 3
    NEAREST_VEL = 4
    NEAREST_ACC = 5
    SHIFT = 6
    """0 forward, 1 reverse."""
    PITCH_RAD = 7
    """In use; until 0.40 the low-passed one."""
    PITCH_RAW_RAD = 8
    PITCH_DEG = 9
    PITCH_RAW_DEG = 10
    ERROR_VEL = 11
    ERROR_VEL_FILTERED = 12
    CONTROL_STATE = 13
    ACC_PID_APPLIED = 14
    ACC_ACC_LIMITED = 15
    ACC_JERK_LIMITED = 16
    ACC_SLOPE_APPLIED = 17
    ACC_PUBLISHED = 18
    PID_P = 19
    PID_I = 20
    PID_D = 21
    FLAG_STOPPING = 22
    """Never set, neither in Autoware nor here."""
    FLAG_EMERGENCY_STOP = 23
    """Never set either."""
    PREDICTED_VEL = 24
    CALCULATED_ACC = 25
    PITCH_TRAJ_RAD = 26
    PITCH_TRAJ_DEG = 27
    STOP_DIST = 28
    FF_SCALE = 29
    ACC_FF = 30
    ERROR_ACC = 31
    ERROR_ACC_FILTERED = 32
    ACC_FB_APPLIED = 33
    PITCH_LPF_RAD = 34
    """Since 0.41, as the two that follow."""
    PITCH_LPF_DEG = 35
    SMOOTH_STOP_MODE = 36


_FROM_TRACE = (
    (Number.TARGET_VEL, "target_vel"),
    (Number.TARGET_ACC, "target_acc"),
    (Number.NEAREST_VEL, "nearest_vel"),
    (Number.ERROR_VEL_FILTERED, "err_vel_filtered"),
    (Number.CONTROL_STATE, "lon_state"),
    (Number.ACC_PID_APPLIED, "acc_pid_applied"),
    (Number.ACC_ACC_LIMITED, "acc_acc_limited"),
    (Number.ACC_JERK_LIMITED, "acc_jerk_limited"),
    (Number.ACC_SLOPE_APPLIED, "acc_slope_applied"),
    (Number.ACC_PUBLISHED, "prev_acc"),
    (Number.PID_P, "pid_p"),
    (Number.PID_I, "pid_i"),
    (Number.PID_D, "pid_d"),
    (Number.PREDICTED_VEL, "pred_vel"),
    (Number.STOP_DIST, "stop_dist"),
    (Number.FF_SCALE, "ff_scale"),
    (Number.ACC_FF, "acc_ff"),
    (Number.ACC_FB_APPLIED, "acc_fb_applied"),
)
"""They keep their old content in the trace where a tick does not set them, as in Autoware."""
_PITCHES = (
    (Number.PITCH_RAD, Number.PITCH_DEG),
    (Number.PITCH_RAW_RAD, Number.PITCH_RAW_DEG),
    (Number.PITCH_TRAJ_RAD, Number.PITCH_TRAJ_DEG),
    (Number.PITCH_LPF_RAD, Number.PITCH_LPF_DEG),
)


class LongitudinalNumbers:
    """Reads what the PID of the last tick worked with; a number is NaN until it is first set.

    Autoware leaves such a number uninitialised.
    """

    def __init__(self, follower: ObservedFollower) -> None:
        self._follower = follower
        node = follower.parameters.node
        self._release = RELEASES.index(node.autoware_release)
        self._is_timed = node.trajectory_reference_mode == ReferenceMode.TEMPORAL.name.lower()
        self._values = np.full(len(Number), np.nan)
        self.trajectory_pitch()  # compiled now, not in the first tick
        self._raw_pitch()

    def trajectory_pitch(self) -> float:
        """Pitch [rad] of the trajectory from the target point on, with the sign of the release."""
        lon, params = self._follower.longitudinal, self._follower.params
        n, target = max(int(lon.n), 2), int(lon.target)
        pitch = float(pitch_ahead(self._follower.path, n, target, float(params.wheel_base)))
        return -pitch if params.slope_turns_in_reverse and not lon.gear_forward else pitch

    def _raw_pitch(self) -> float:
        inputs = self._follower.inputs[0]
        return float(body_pitch(inputs.qx, inputs.qy, inputs.qz, inputs.qw))

    def read(self) -> npt.NDArray[np.float32]:
        """Return the numbers."""
        trace, values = self._follower.trace[0], self._values
        for place, name in _FROM_TRACE:
            values[place] = trace[name]
        self._read_state()
        self._read_pitches()
        if trace.smooth_stop_mode >= 0:
            values[Number.SMOOTH_STOP_MODE] = trace.smooth_stop_mode
        if self._release < _TELLS_PITCH_IN_USE:
            return values[: Number.PITCH_LPF_RAD].astype(np.float32)
        if self._release < _TELLS_TEMPORAL:
            return values.astype(np.float32)
        return np.append(values, temporal_values(self._time())).astype(np.float32)

    def _read_state(self) -> None:
        lon, inputs, values = (
            self._follower.longitudinal,
            self._follower.inputs[0],
            self._values,
        )
        values[Number.DT] = lon.dt
        values[Number.CURRENT_VEL] = inputs.vx
        values[Number.CALCULATED_ACC] = inputs.ax
        values[Number.NEAREST_ACC] = self._follower.path[int(lon.nearest)].acc
        values[Number.SHIFT] = not lon.gear_forward
        values[Number.ERROR_VEL] = values[Number.NEAREST_VEL] - inputs.vx
        if self._moves():
            turns = self._follower.params.feedback_turns_in_reverse and not lon.gear_forward
            values[Number.ERROR_ACC] = (-inputs.ax if turns else inputs.ax) - lon.raw_acc
            values[Number.ERROR_ACC_FILTERED] = lon.acc_error

    def _moves(self) -> bool:
        """Whether the tick came to the feedback of the acceleration."""
        trace = self._follower.trace[0]
        return trace.lon_state != LongitudinalState.STOPPED and not trace.far_from_trajectory

    def _read_pitches(self) -> None:
        lon = self._follower.longitudinal
        used = lon.slope if self._release >= _TELLS_PITCH_IN_USE else lon.pitch
        found = (used, self._raw_pitch(), self.trajectory_pitch(), lon.pitch)
        for (radians, degrees), pitch in zip(_PITCHES, found, strict=True):
            self._values[radians], self._values[degrees] = pitch, math.degrees(pitch)

    def _time(self) -> float | None:
        lon = self._follower.longitudinal
        return float(lon.times[int(lon.nearest)]) if self._is_timed else None
