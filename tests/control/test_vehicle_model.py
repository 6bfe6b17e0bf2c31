# SPDX-License-Identifier: Apache-2.0
"""The three prediction models: closed forms against the transform of their equations."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safety_island.control.records import pack_parameters
from safety_island.control.vehicle_model import discretize, feed_forward
from tests.control import dense_mpc
from tests.control.vehicles import FRONT_HEAVY
from tests.control.vehicles import MODELS as PLAIN_MODELS
from tests.golden.harness import firmware

MODELS = PLAIN_MODELS | {"front heavy": {"vehicle_model_type": "dynamics"} | FRONT_HEAVY}
SETS = {name: firmware(**values) for name, values in MODELS.items()}
RECORDS = {name: pack_parameters(values)[0] for name, values in SETS.items()}


def discrete(name: str, v: float, k: float, dt: float) -> dense_mpc.Model:
    """What the controller makes of a model; what lies outside its states must be zero."""
    a, b, w = np.zeros((4, 4)), np.zeros(4), np.zeros(4)
    discretize(RECORDS[name], v, k, dt, np.zeros((4, 12)), a, b, w)
    size = {"kinematics": 3, "no delay": 2}.get(name, 4)
    assert (
        not a[size:].any() and not a[:, size:].any() and not b[size:].any() and not w[size:].any()
    )
    return a[:size, :size], b[:size], w[:size]


def check(name: str, v: float, k: float, dt: float) -> None:
    expected = dense_mpc.bilinear(dense_mpc.continuous(SETS[name], v, k), dt)
    for found, wanted in zip(discrete(name, v, k, dt), expected, strict=True):
        scale = max(1.0, float(np.abs(wanted).max()))
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-11 * scale)


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("v", [0.0, 1e-5, -1e-5, 0.005, 1.0, -2.0, 30.0])
@pytest.mark.parametrize("k", [0.0, 0.02, -0.3, 2.0, -2.0])
def test_the_discrete_model_is_the_bilinear_transform(name: str, v: float, k: float) -> None:
    """Down to standstill, in reverse, and with a curvature beyond the steering's limit."""
    check(name, v, k, 0.1)


@given(
    name=st.sampled_from(sorted(MODELS)),
    v=st.floats(-20.0, 40.0),
    k=st.floats(-1.0, 1.0),
    dt=st.floats(0.01, 1.1),
)
@settings(max_examples=200, deadline=None)
def test_it_is_at_any_speed_curvature_and_step(name: str, v: float, k: float, dt: float) -> None:
    check(name, v, k, dt)


def test_the_smallest_speed_of_the_kinematic_model_keeps_its_sign() -> None:
    """A[0, 1] is the step's length: 1e-4 m/s for 0.1 s, forward at zero."""
    for v, length in ((0.0, 1e-5), (-0.0, 1e-5), (5e-324, 1e-5), (-5e-324, -1e-5), (1e-3, 1e-4)):
        assert discrete("kinematics", v, 0.0, 0.1)[0][0, 1] == pytest.approx(length, rel=1e-12)


def test_the_other_models_have_other_smallest_speeds() -> None:
    assert discrete("no delay", 0.0, 0.1, 0.1)[1].tolist() == [0.0, 0.0], "none: it stands"
    for v in (0.0, -5.0, 0.01):
        for ours, wanted in zip(
            discrete("dynamics", v, 0.1, 0.1), discrete("dynamics", 0.01, 0.1, 0.1), strict=True
        ):
            np.testing.assert_array_equal(ours, wanted)


def test_a_vehicle_on_its_path_with_the_angle_of_its_curvature_stays_there() -> None:
    """Of the kinematic model: e = yaw error = 0, steering at atan(L k) is an equilibrium."""
    k, v = 0.05, 7.0
    angle = math.atan(2.74 * k)
    a, b, w = discrete("kinematics", v, k, 0.1)
    state = np.array([0.0, 0.0, angle])
    np.testing.assert_allclose(a @ state + b * angle + w, state, rtol=0, atol=1e-15)
    a, b, w = discrete("no delay", v, k, 0.1)
    np.testing.assert_allclose(b * angle + w, 0.0, rtol=0, atol=1e-15)


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("k", [0.0, 0.002, -0.004, 0.05, -0.4])
def test_the_feed_forward_holds_the_curvature(name: str, k: float) -> None:
    """Angles below half a degree are left out: up to about 0.0032 1/m with this wheelbase."""
    found = feed_forward(RECORDS[name], 9.0, k)
    assert found == pytest.approx(dense_mpc.feed_forward(SETS[name], 9.0, k), rel=1e-13)
    if name == "kinematics":
        assert found == (math.atan(2.74 * k) if abs(k) > 0.0033 else 0.0)


def test_an_understeering_vehicle_steers_more() -> None:
    """m (lr / cf - lf / cr) / 2 L is positive where the front is heavy or the rear stiff."""
    m, lf, lr, cf, cr = 2600.0, 2.74 * 1200 / 2600, 2.74 * 1400 / 2600, 155494.663, 120000.0
    extra = m * (lr / cf - lf / cr) / (2 * 2.74)
    angle = feed_forward(RECORDS["front heavy"], 10.0, 0.05)
    assert angle == pytest.approx(0.05 * (2.74 + extra * 100.0), rel=1e-12)
