# SPDX-License-Identifier: Apache-2.0
"""Low passes: the moving average over the path and the second-order Butterworth filter."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from safety_island.control.filters import butterworth
from safety_island.control.lateral_state import FILTER
from safety_island.control.reference_smoothing import moving_average
from safety_island.kernel.records import record
from tests.control.lateral_rig import Values, line, on_path

MEMORY = record(FILTER)


def averaged(values: list[float], reach: int) -> tuple[bool, list[float]]:
    given = np.array(values)
    done = moving_average(given, np.full(len(values), np.nan), len(values), reach)
    return bool(done), given.tolist()


def test_a_window_longer_than_the_values_leaves_them() -> None:
    assert averaged([1.0, 3.0, 4.0, 6.0], 5) == (False, [1.0, 3.0, 4.0, 6.0])


def test_a_window_of_the_point_alone_changes_nothing() -> None:
    assert averaged([1.0, 3.0, 4.0, 6.0], 0) == (True, [1.0, 3.0, 4.0, 6.0])


@pytest.mark.parametrize(
    ("values", "reach", "means"),
    [
        ([1.0, 3.0, 4.0, 6.0], 1, [1.0, 8 / 3, 13 / 3, 6.0]),
        ([1.0, 3.0, 4.0, 6.0, 7.0, 10.0], 2, [1.0, 8 / 3, 21 / 5, 30 / 5, 23 / 3, 10.0]),
        ([1.0, 3.0, 4.0], 3, [1.0, 8 / 3, 4.0]),  # no full window at all
    ],
)
def test_the_window_shrinks_toward_the_ends(
    values: list[float], reach: int, means: list[float]
) -> None:
    done, found = averaged(values, reach)
    assert done
    assert found == pytest.approx(means, abs=1e-15)


def test_zeros_stay_zeros_behind_whatever_came_before() -> None:
    """A rest of 1e-17 m/s has a sign, and the sign of a speed is the driving direction."""
    _, found = averaged([0.1, -0.7, 1e9, 0.3] * 5 + [0.0] * 20, 5)
    assert found[25:] == [0.0] * 15


def coefficients(cutoff_hz: float, period: float) -> Values:
    """a1, a2, b0, b1, b2 as the filter shows them: its answer to a memory or input of one."""
    found = []
    for name in ("y1", "y2", "input", "u1", "u2"):
        memory = np.zeros(1, MEMORY)
        if name != "input":
            memory[0][name] = 1.0
        found.append(butterworth(memory[0], float(name == "input"), cutoff_hz, period))
    return np.array(found)


@pytest.mark.parametrize(
    ("period", "cutoff_hz", "expected"),
    [
        (0.033, 1.0, (1.7084658, -0.7458606, 0.0093487, 0.0186974, 0.0093487)),
        (0.05, 2.0, (1.1429805, -0.4128016, 0.0674553, 0.1349105, 0.0674553)),
        (0.03, 10.0, (-0.36953, -0.19582, 0.39134, 0.78268, 0.39134)),  # the firmware's at 30 ms
    ],
)
def test_known_coefficients(period: float, cutoff_hz: float, expected: tuple[float, ...]) -> None:
    tolerance = 1e-6 if period != 0.03 else 1e-5
    np.testing.assert_allclose(coefficients(cutoff_hz, period), expected, rtol=0, atol=tolerance)


@pytest.mark.parametrize("share", [0.01, 0.1, 0.3, 0.49, 0.4999])
def test_it_is_a_stable_low_pass_below_the_nyquist_frequency(share: float) -> None:
    """Gain 1 at rest, 1/sqrt(2) at the cutoff, 0 at Nyquist, poles inside the unit circle."""
    a1, a2, b0, b1, b2 = coefficients(share, 1.0)

    def gain(frequency: float) -> float:
        z = np.exp(2j * np.pi * frequency)
        return float(abs((b0 + b1 / z + b2 / z**2) / (1 - a1 / z - a2 / z**2)))

    assert gain(0.0) == pytest.approx(1.0, abs=1e-9)
    assert gain(share) == pytest.approx(math.sqrt(0.5), abs=1e-9)
    assert gain(0.5) == pytest.approx(0.0, abs=1e-6)
    assert np.abs(np.roots([1.0, -a1, -a2])).max() < 1.0


@pytest.mark.parametrize("cutoff_hz", [0.5, 0.51, 1.0, 10.0, 1000.0])
def test_from_the_nyquist_frequency_on_the_input_passes(cutoff_hz: float) -> None:
    """And the memory stays as it is, so that nothing can grow in it."""
    memory: Any = np.zeros(1, MEMORY)
    for u in (1.0, -2.0, 0.25):
        assert butterworth(memory[0], u, cutoff_hz, 1.0) == u
    assert memory.tobytes() == bytes(memory.nbytes)


def test_a_ramp_comes_out_late() -> None:
    memory = np.zeros(1, MEMORY)
    ramp = [float(i) for i in range(30)]
    out = [butterworth(memory[0], u, 0.1, 1.0) for u in ramp]
    assert out[0] == ramp[0] == 0.0
    assert all(y < u for y, u in zip(out[1:], ramp[1:], strict=True))
    assert out[-1] - out[-2] == pytest.approx(1.0, abs=1e-3), "as steep as it came in"


@pytest.mark.parametrize(("cutoff_hz", "passes"), [(3.0, False), (3.4, True), (10.0, True)])
def test_the_commands_filter_obeys_it(cutoff_hz: float, passes: bool) -> None:
    """Nyquist is 3.33 Hz at the firmware's 0.15 s: its 10 Hz pass the solution on."""
    rig = on_path(line(40.0), steering_lpf_cutoff_hz=cutoff_hz)
    rig.place(0.0, 0.3)
    trace = rig.tick()
    assert (rig.angle == np.float32(trace.u[0])) == passes
    assert abs(rig.angle) < 0.5
