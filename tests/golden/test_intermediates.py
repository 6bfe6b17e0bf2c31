# SPDX-License-Identifier: Apache-2.0
"""What the MPC computes on the way, against dumps of single ticks of the firmware.

A dump (``dumps/<scenario>__<run>_dump<tick>.npz``) holds ``reference`` (x, y [m], speed [m/s]),
``filtered`` (speed after the velocity filter, time [s]), ``horizon`` (speed, curvature, curvature
of the feed-forward), ``x0``, ``x0_delayed``, ``u_ref``, ``H`` (its lower triangle, row by row),
``f``, the four bounds and the solution ``u``.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from safety_island.control.follower import TrajectoryFollower
from safety_island.control.reference_positions import ensure
from tests.control.condensed import condensed
from tests.golden.harness import parameters_of, played, recorded

DUMPS = Path(__file__).parent / "dumps"
NAMES = sorted(path.stem for path in DUMPS.glob("*.npz"))
TOLERANCE = 1e-9
Arrays = dict[str, Any]


@cache
def dump(name: str) -> Arrays:
    with np.load(DUMPS / f"{name}.npz") as data:
        return {key: data[key] for key in data.files}


@cache
def ours(name: str) -> tuple[Any, Any]:
    """The lateral state and the problem after the tick of a dump."""
    run_name, _, last = name.replace("__", "/").rpartition("_dump")
    run = recorded(run_name)
    follower = TrajectoryFollower(parameters_of(run))
    for tick, now in played(run, follower):
        follower.step(now)
        if tick == int(last):
            break
    lat = follower._lateral[0]
    ensure(lat, 0, lat.ref_n)
    return lat, condensed(follower._params, follower._lateral, follower._qp)


def close(found: Any, recorded: Any, scale: float = 1.0) -> None:
    np.testing.assert_allclose(found, recorded, rtol=0, atol=TOLERANCE * scale)


def of_solution(name: str) -> float:
    """How much further off a solution may be: OSQP's own error in its runs."""
    return 1e3 if "osqp" in name else 1.0


@pytest.mark.parametrize("name", NAMES)
def test_the_reference_path(name: str) -> None:
    (lat, _), reference = ours(name), dump(name)["reference"]
    n = len(reference)
    assert n == lat.ref_n + 1  # with the closing duplicate
    for i, column in enumerate(("rx", "ry", "rv")):
        close(lat[column][:n], reference[:, i])


@pytest.mark.parametrize("name", NAMES)
def test_the_velocity_filter(name: str) -> None:
    (lat, _), filtered = ours(name), dump(name)["filtered"]
    assert len(filtered) == lat.ref_n + 2
    part = slice(lat.segment, lat.segment + lat.window)  # nothing else is ever read
    close(lat.wv[: lat.window], filtered[part, 0])
    close(lat.wt[: lat.window], filtered[part, 1] - filtered[lat.segment, 1])


@pytest.mark.parametrize("name", NAMES)
def test_the_horizon_and_the_initial_state(name: str) -> None:
    (lat, _), recorded = ours(name), dump(name)
    n, states = len(recorded["u"]), len(recorded["x0"])
    close(lat.hv[:n], recorded["horizon"][:, 0])
    close(lat.hk[:n], recorded["horizon"][:, 1])
    close(lat.hks[:n], recorded["horizon"][:, 2])
    close(lat.u_ref[:n], recorded["u_ref"])
    close(lat.x0[:states], recorded["x0"])
    close(lat.x0_delayed[:states], recorded["x0_delayed"])


@pytest.mark.parametrize("name", NAMES)
def test_the_quadratic_programme(name: str) -> None:
    (_, qp), recorded = ours(name), dump(name)
    n = len(recorded["u"])
    largest = np.abs(recorded["H"]).max()
    close(qp.H[:n, :n][np.tril_indices(n)], recorded["H"], largest)
    np.testing.assert_array_equal(qp.H[:n, :n], qp.H[:n, :n].T)
    close(qp.f[:n], recorded["f"], np.abs(recorded["f"]).max())
    for key in ("lb", "ub", "lbA", "ubA"):
        close(qp[key][1:n], recorded[key][1:])
        close(qp[key][0], recorded[key][0], of_solution(name))  # from the last solution


@pytest.mark.parametrize("name", NAMES)
def test_the_solution(name: str) -> None:
    (_, qp), u = ours(name), dump(name)["u"]
    close(qp.u[: len(u)], u, of_solution(name))
