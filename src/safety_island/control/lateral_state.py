# SPDX-License-Identifier: Apache-2.0
"""Everything that the lateral controller remembers, and the memory in which it works."""

import numpy as np

from safety_island.control.limits import (
    EXTENSION_POINTS,
    MAX_DELAY_STEPS,
    MAX_HISTORY,
    MAX_HORIZON,
    MAX_OFFSET_SAMPLES,
    MAX_POINTS,
    MAX_REFERENCE,
    MAX_SHAPE_HISTORY,
)
from safety_island.control.params import Parameters
from safety_island.kernel.records import Records, record

_STATES = 4  # of the largest vehicle model
_SKEW = 40
"""Numbers between two long columns, five lines of a cache: columns that lie a power of two apart
share their places in the cache, and a tick that reads twenty of them would displace its own."""
_SOURCE = MAX_POINTS + _SKEW
_TIMED = MAX_POINTS + EXTENSION_POINTS + 2 + _SKEW
_LONGEST = MAX_REFERENCE + 2 + _SKEW  # the reference with its two closing duplicates

FILTER = [
    ("u1", "f8"),  # the last two inputs and outputs
    ("u2", "f8"),
    ("y1", "f8"),
    ("y2", "f8"),
]

SOURCE_COLUMNS = [
    ("source_id", "i8"),  # trajectory_id of the accepted trajectory; 0: none
    ("source_n", "i8"),
    ("source_yaw_end", "f8"),  # yaw of its last point [rad]
    ("source_is_forward", "?"),  # its points face the way that they lead
    ("px", "f8", (_SOURCE,)),  # its points [m]
    ("py", "f8", (_SOURCE,)),
    ("pz", "f8", (_SOURCE,)),
    ("pyaw", "f8", (_SOURCE,)),  # unwrapped yaw [rad], as far as it was needed
    ("pv", "f8", (_SOURCE,)),  # speed [m/s]
    ("arc", "f8", (_SOURCE,)),  # 2-D arc length [m]
    ("mx", "f8", (_SOURCE,)),  # second derivatives of the natural cubic splines
    ("my", "f8", (_SOURCE,)),
    ("mz", "f8", (_SOURCE,)),
    ("myaw", "f8", (_SOURCE,)),
    ("gain", "f8", (_SOURCE,)),  # elimination factors of the tridiagonal system
]

REFERENCE_COLUMNS = [
    ("ref_n", "i8"),  # points of the reference, without closing duplicates; 0: none yet
    ("ready", "i8"),  # how many of them, the first closing duplicate counted, are worked out
    ("cursor", "i8"),  # the interval of the source in which that ended
    ("rs", "f8", (_LONGEST,)),  # arc length at which each stands [m]
    ("rx", "f8", (_LONGEST,)),  # position [m]
    ("ry", "f8", (_LONGEST,)),
    ("rz", "f8", (_LONGEST,)),
    ("rv", "f8", (_LONGEST,)),  # speed [m/s]
    ("short_yaw", "f8", (2,)),  # yaw of a reference of fewer than three points [rad]
    ("smooth", "f8", (_LONGEST,)),  # work memory of the moving average
    ("anchor", "i8"),  # index of the ego's projection
    ("is_forward", "?"),
    ("is_timed", "?"),  # the points are as received, each with its time, yaw and curvature:
    ("rt", "f8", (_TIMED,)),  # time_from_start [s]
    ("ryaw", "f8", (_TIMED,)),  # [rad]
    ("rk", "f8", (_TIMED,)),  # curvature [1/m] over ``curvature_reach`` points
    ("rks", "f8", (_TIMED,)),  # curvature for the feed-forward [1/m]
    ("curvature_reach", "i8"),
    ("one_sided_ends", "?"),  # the rule of that name, for those who have no parameters
]

PREDICTION_COLUMNS = [
    ("segment", "i8"),  # of the reference that holds the ego's projection
    ("nearest", "i8"),
    ("nearest_time", "f8"),  # [s], counted from the segment's first point
    ("wt", "f8", (_LONGEST,)),  # time of the reference points from the segment on [s]
    ("wv", "f8", (_LONGEST,)),  # their filtered speed [m/s]
    ("window", "i8"),  # how many of them are computed
    ("prediction_dt", "f8"),
    ("hv", "f8", (MAX_HORIZON,)),  # over the horizon: speed [m/s],
    ("hk", "f8", (MAX_HORIZON,)),  # curvature [1/m],
    ("hks", "f8", (MAX_HORIZON,)),  # curvature for the feed-forward [1/m]
    ("A", "f8", (MAX_HORIZON, _STATES, _STATES)),  # discrete model of each step
    ("B", "f8", (MAX_HORIZON, _STATES)),
    ("W", "f8", (MAX_HORIZON, _STATES)),
    ("Ac", "f8", (_STATES, 3 * _STATES)),  # work memory of the bilinear transform
    ("u_ref", "f8", (MAX_HORIZON,)),  # feed-forward steering [rad]
    ("q_lat", "f8", (MAX_HORIZON,)),  # weights
    ("q_yaw", "f8", (MAX_HORIZON,)),
    ("r0", "f8", (MAX_HORIZON,)),  # R1: diagonal and two side diagonals
    ("r1", "f8", (MAX_HORIZON,)),
    ("r2", "f8", (MAX_HORIZON,)),
    ("jerk", "f8", (MAX_HORIZON,)),  # R2: weight between steps i and i + 1
    ("x0", "f8", (_STATES,)),
    ("x0_delayed", "f8", (_STATES,)),
    ("free", "f8", (MAX_HORIZON, _STATES)),  # response without input
    ("cost", "f8", (_STATES, _STATES)),  # cost to go of the condensing recursion
    ("cost_next", "f8", (_STATES, _STATES)),
    ("row", "f8", (MAX_HORIZON, _STATES)),
    ("columns", "f8", (_STATES, MAX_HORIZON)),
]

MEMORY_COLUMNS = [
    ("lateral_error_prev", "f8"),
    ("yaw_error_prev", "f8"),
    ("steering_filter", record(FILTER)),
    ("lateral_filter", record(FILTER)),
    ("yaw_filter", record(FILTER)),
    ("raw_prev", "f8"),  # raw_steer_cmd_prev [rad]
    ("raw_pprev", "f8"),
    ("delay_n", "i8"),  # entries of the input delay buffer
    ("delay", "f4", (MAX_DELAY_STEPS,)),  # oldest first [rad]
    ("measured", "f4"),  # tyre angle of this tick, without the offset of the sensor [rad]
    ("is_under_control", "?"),
    # steering predictor
    ("predictor_n", "i8"),
    ("predictor_u", "f4", (MAX_HISTORY,)),
    ("predictor_t", "f8", (MAX_HISTORY,)),
    ("predictor_time", "f8"),
    ("predictor_started", "?"),
    ("predicted", "f8"),
    # steering offset [rad]
    ("offset", "f8"),  # in force
    ("offset_target", "f8"),  # that it follows, when it comes from a topic
    ("offset_filter", record(FILTER)),
    ("offset_sum", "f8"),
    ("offset_head", "i8"),
    ("offset_samples", "f8", (MAX_OFFSET_SAMPLES,)),
    # wrapper
    ("cmd_prev_angle", "f4"),
    ("cmd_prev_rate", "f4"),
    ("cmd_prev_valid", "?"),
    ("output_angle", "f4"),  # the last output
    ("history_n", "i8"),
    ("history_u", "f4", (MAX_HISTORY,)),
    ("history_t", "f8", (MAX_HISTORY,)),
    ("history_filled", "?"),
    ("ends_n", "i8"),  # end points of past trajectories
    ("ends_x", "f8", (MAX_SHAPE_HISTORY,)),
    ("ends_y", "f8", (MAX_SHAPE_HISTORY,)),
    ("ends_t", "f8", (MAX_SHAPE_HISTORY,)),
    ("ends_id", "i8"),
]

LATERAL_STATE = record(SOURCE_COLUMNS + REFERENCE_COLUMNS + PREDICTION_COLUMNS + MEMORY_COLUMNS)


def new_lateral_state(parameters: Parameters) -> Records:
    """Return the (1,) start state: no reference, every memory zero, driving forward.

    Raises ValueError when the input delay is longer than MAX_DELAY_STEPS periods.
    """
    state = np.zeros(1, LATERAL_STATE)
    steps = delay_steps(parameters)
    if steps > MAX_DELAY_STEPS:
        raise ValueError(f"input_delay is {steps} control periods, at most {MAX_DELAY_STEPS} fit")
    state[0].delay_n = steps
    state[0].is_forward = True
    return state


def delay_steps(parameters: Parameters) -> int:
    """The input delay in whole control periods, rounded half away from zero."""
    return int(parameters.lateral.input_delay / parameters.node.ctrl_period + 0.5)
