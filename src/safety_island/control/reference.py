# SPDX-License-Identifier: Apache-2.0
"""The reference path of the MPC: the accepted trajectory, resampled by arc length at the ego.

Only the stations are placed for the whole path. Positions and speeds (``reference_positions``), yaw
and curvature (``reference_shape``) are worked out where they are asked for, which gives the same
numbers.
"""

from safety_island.control.geometry import clip, yaw_of
from safety_island.control.limits import MAX_REFERENCE
from safety_island.control.points import advance, nearest_index, offset_along, segment_of
from safety_island.control.reference_positions import (
    close,
    extend,
    leave_source,
    work_out,
    work_out_whole,
)
from safety_island.control.reference_shape import starts_close
from safety_island.control.reference_smoothing import smooth_reference
from safety_island.control.spline import (
    fit_space_curve,
    interval_from,
    second_derivatives,
    spline_value,
    unwrap_step,
)
from safety_island.kernel.kernel import kernel

_NO_INFLUENCE = 1e-16
"""Share of a knot's second derivative, in that of an earlier knot, that double precision loses."""


@kernel
def _is_point(points, n):
    """Whether a trajectory is about as short as a micrometre."""
    length = 0.0
    for i in range(1, n):
        length += abs(points[i].x - points[i - 1].x) + abs(points[i].y - points[i - 1].y)
        if length > 4e-6:
            return False
    return True


@kernel
def accept_source(params, points, n, lat):
    """Take over a received trajectory of n >= 3 points: arc length and spline coefficients."""
    if _is_point(points, n):  # it will make no reference, and the one in force stays
        leave_source(lat)
    px = lat.px
    py = lat.py
    pz = lat.pz
    pv = lat.pv
    ahead = 0.0
    for i in range(n):
        point = points[i]
        px[i] = point.x
        py[i] = point.y
        pz[i] = point.z
        pv[i] = point.v
        if i > 0:
            way, _ = advance(points[i - 1], px[i] - px[i - 1], py[i] - py[i - 1])
            ahead += way
    lat.source_is_forward = ahead > 0.0
    last = points[n - 1]
    lat.source_yaw_end = yaw_of(last.qx, last.qy, last.qz, last.qw)
    fit_space_curve(lat.arc, lat.gain, px, py, pz, lat.mx, lat.my, lat.mz, n)
    lat.source_n = n
    lat.bulge = _bulge(lat, n)


@kernel
def _bulge(lat, n):
    """How far a place of the curve can be from the nearer end of its interval [m], at most.

    On the chord of an interval of length h that is h / 2. A curve is away from its chord by h^2 / 8
    of its greatest second derivative at most, which a cubic has at an end.
    """
    bulge = 0.0
    for i in range(n - 1):
        h = lat.arc[i + 1] - lat.arc[i]
        bend = max(abs(lat.mx[i]), abs(lat.mx[i + 1])) + max(abs(lat.my[i]), abs(lat.my[i + 1]))
        bulge = max(bulge, h * (0.5 + 0.125 * h * bend))
    return bulge


@kernel
def _fit_yaw(points, n, lat, reach):
    """Fit the yaw spline as far as its start depends on it: up to ``reach`` [m] it is asked for.

    What a knot adds to the one before it is multiplied by ``gain``, which is a half at most.
    """
    count = 2
    influence = 1.0
    while count < n and influence > _NO_INFLUENCE:
        if lat.arc[count - 1] >= reach:
            influence *= lat.gain[count - 1]
        count += 1
    previous = 0.0
    for i in range(count):
        point = points[i]
        own = yaw_of(point.qx, point.qy, point.qz, point.qw)
        previous = own if i == 0 else unwrap_step(own, previous)
        lat.pyaw[i] = previous
    second_derivatives(lat.arc, lat.gain, lat.pyaw, lat.myaw, count)


@kernel
def _place_stations(lat, start, step):
    """Fill the arc lengths of the reference points, anchored at the ego's projection.

    Backward from clip(start), forward from max(start, 0) + step, each by running addition as the
    firmware does. Returns the number of points; the arrays hold MAX_REFERENCE at the most.
    """
    rs = lat.rs
    length = lat.arc[lat.source_n - 1]
    s = clip(start, 0.0, length - 1e-6)
    count = 0
    while s >= 0.0 and count < MAX_REFERENCE:
        rs[count] = s
        count += 1
        s -= step
    for i in range(count // 2):
        swap = rs[i]
        rs[i] = rs[count - 1 - i]
        rs[count - 1 - i] = swap
    lat.anchor = max(count - 1, 0)
    s = max(start, 0.0) + step
    while s < length and count < MAX_REFERENCE:
        rs[count] = s
        count += 1
        s += step
    return count


@kernel
def _set_direction(params, points, lat, count):
    """Set the driving direction, kept for a single point; and the yaw of a short reference.

    The whole trajectory counts, not its first point: a spline through the yaws of two points that
    are close together may be turned round between them.
    """
    if count >= 2:
        lat.is_forward = lat.source_is_forward
    if count < 3 or (params.one_sided_ends and starts_close(lat)):
        _fit_yaw(points, lat.source_n, lat, 2.0 * params.traj_resample_dist)
        for i in range(min(count, 2)):
            j = interval_from(lat.arc, lat.source_n, 0, lat.rs[i])
            lat.short_yaw[i] = spline_value(lat.arc, lat.pyaw, lat.myaw, j, lat.rs[i])


@kernel
def update_reference(params, points, inputs, lat):
    """Resample the accepted trajectory anew at the ego's projection."""
    n = lat.source_n
    yaw = yaw_of(inputs.qx, inputs.qy, inputs.qz, inputs.qw)
    nearest = nearest_index(
        points,
        n,
        inputs.x,
        inputs.y,
        yaw,
        params.ego_nearest_dist_threshold,
        params.ego_nearest_yaw_threshold,
    )
    segment = segment_of(points, n, nearest, inputs.x, inputs.y)
    start = lat.arc[segment] + offset_along(points, segment, inputs.x, inputs.y)
    count = _place_stations(lat, start, params.traj_resample_dist)
    if count == 0:  # shorter than a micrometre: nothing to follow, the old reference stays
        return
    lat.ref_n = count
    lat.first = lat.ready = lat.cursor = 0
    lat.is_on_splines = True
    lat.one_sided_ends = params.one_sided_ends
    smooths = params.enable_path_smoothing and count > 2 * params.path_filter_moving_ave_num
    if not smooths and not params.extend_trajectory_for_end_yaw_control:
        work_out(lat, 0, min(count, 3))  # the direction reads these
        _set_direction(params, points, lat, count)
        return
    work_out_whole(lat, count)
    _set_direction(params, points, lat, count)
    if smooths:
        smooth_reference(lat, count, params.path_filter_moving_ave_num)
    if params.extend_trajectory_for_end_yaw_control:
        count = extend(params, lat, count)
    close(lat, count)
