# SPDX-License-Identifier: Apache-2.0
"""Model and feed-forward of every step of the MPC's horizon."""

from safety_island.control.vehicle_model import discretize, feed_forward
from safety_island.kernel.kernel import kernel


@kernel
def build_models(params, lat, horizon):
    """Fill the discrete model and the feed-forward of every step."""
    sign = 1.0 if lat.is_forward else -1.0
    for i in range(horizon):
        v = lat.hv[i]
        k = sign * lat.hk[i]
        discretize(params, v, k, lat.prediction_dt, lat.Ac, lat.A[i], lat.B[i], lat.W[i])
        lat.u_ref[i] = feed_forward(params, v, sign * lat.hks[i])
