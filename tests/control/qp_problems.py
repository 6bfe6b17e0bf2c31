# SPDX-License-Identifier: Apache-2.0
"""Quadratic programmes for the solver tests: recorded ones and seeded families of hard ones."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import daqp
import numpy as np
import numpy.typing as npt

from safety_island.bench import yardstick
from safety_island.control.qp import QP

Array = npt.NDArray[np.float64]
Record = npt.NDArray[Any]
DATA = Path(__file__).parent / "data"
BOUNDS = ("lb", "ub", "lbA", "ubA")
RECORDED = {
    "s_curve": Path(yardstick.__file__).parent / "data" / "yardstick.npz",  # no bound is touched
    "lane_change": DATA / "qp_lane_change.npz",  # the same, worse conditioned
    "u_turn": DATA / "qp_u_turn.npz",  # 44 bounds are touched
}


def problem(h: Array, f: Array, lb: Array, ub: Array, lb_rate: Array, ub_rate: Array) -> Record:
    """Return the (1,) record of a problem; ``h`` is (n, n), the others (n,)."""
    n = f.size
    q = np.zeros(1, QP)
    q[0].H[:n, :n] = h
    for key, value in zip(("f", *BOUNDS), (f, lb, ub, lb_rate, ub_rate), strict=True):
        q[0][key][:n] = value
    return q


def recorded(name: str) -> tuple[Record, int]:
    """Return a problem of the golden runs and its size."""
    with np.load(RECORDED[name]) as file:
        return problem(file["H"], *(file[key].ravel() for key in ("f", *BOUNDS))), len(file["H"])


def random_hessian(rng: np.random.Generator, n: int, condition: float) -> Array:
    """Return a random symmetric positive definite matrix of that condition number."""
    basis = np.linalg.qr(rng.normal(size=(n, n)))[0]
    h = (basis * np.geomspace(1.0, condition, n)) @ basis.T
    return np.asarray((h + h.T) / 2)


def smooth_hessian(n: int, condition: float) -> Array:
    """Return a matrix with the structure of the MPC's: a lower triangular response, weighted."""
    lag = np.arange(n)[:, None] - np.arange(n)[None, :]
    response = np.where(lag >= 0, (lag + 1) * np.exp(-0.05 * lag), 0.0)
    h = response.T @ response
    return np.asarray(h * (condition / np.linalg.eigvalsh(h)[-1]) + np.eye(n))


def random_problem(rng: np.random.Generator, n: int, h: Array, family: str) -> Record:
    """Return a feasible problem (u = 0 is always inside) of a family.

    ``plain``: constant limits; ``rows``: other limits in each row; ``equal``: some rates fixed;
    ``frozen``: every rate but the first is fixed at 0; ``double``: the two rows of u_0 coincide;
    ``narrow``: boxes of 1e-12 width.
    """
    free = np.cumsum(rng.normal(size=n)) * 10.0 ** rng.uniform(-2, 1)
    box = np.full(n, np.abs(free).max() * 10.0 ** rng.uniform(-2, 0.3))
    rate = np.full(n, np.abs(np.diff(free, prepend=0.0)).max() * 10.0 ** rng.uniform(-2, 0.3))
    low, high, low_rate, high_rate = -box, box.copy(), -rate * rng.choice([1.0, 0.3]), rate.copy()
    if family in ("rows", "equal", "double"):
        low, high, low_rate, high_rate = (
            bound * rng.uniform(0.0, 1.0, n) for bound in (low, high, low_rate, high_rate)
        )
    if family == "equal":
        fixed = rng.integers(0, n, 3)
        low_rate[fixed] = high_rate[fixed] = 0.0
    if family == "frozen":
        low_rate[1:] = high_rate[1:] = 0.0
    if family == "double":
        low_rate[0], high_rate[0] = low[0], high[0]
    if family == "narrow":
        middle = box * 0.5 * np.sin(np.arange(n) / 5)
        low, high, low_rate, high_rate = middle - 5e-13, middle + 5e-13, -4 * box, 4 * box
    return problem(h, -h @ free, low, high, low_rate, high_rate)


def reference(q: Record, n: int) -> tuple[Array, int]:
    """Solve with PyPI's daqp; returns u (n,) and its exit flag (1 solved, -1 infeasible)."""
    r = q[0]
    rows = np.eye(n) - np.eye(n, k=-1)
    upper = np.concatenate([r.ub[:n], r.ubA[:n]])
    lower = np.concatenate([r.lb[:n], r.lbA[:n]])
    sense = np.zeros(2 * n, dtype=np.int32)
    h, f = r.H[:n, :n].copy(), r.f[:n].copy()
    tolerances = {"primal_tol": 1e-12, "dual_tol": 1e-14}
    u, _, flag, _ = daqp.solve(h, f, rows, upper, lower, sense, **tolerances)
    return np.asarray(u), int(flag)


def cost(q: Record, n: int, u: Array) -> float:
    """Return the objective at ``u`` (n,)."""
    return float(0.5 * u @ q[0].H[:n, :n] @ u + q[0].f[:n] @ u)
