# SPDX-License-Identifier: Apache-2.0
"""The vehicles of the tests: masses and tyres for the dynamics model, and each model by name."""

from __future__ import annotations

from typing import Any

MASSES = {f"vehicle_mass_{wheel}": 600.0 for wheel in ("fl", "fr", "rl", "rr")}
DYNAMICS = MASSES | {"vehicle_cf": 155494.663, "vehicle_cr": 155494.663}
FRONT_HEAVY = DYNAMICS | {"vehicle_mass_fl": 800.0, "vehicle_cr": 120000.0}
MODELS: dict[str, dict[str, Any]] = {
    "kinematics": {"vehicle_model_type": "kinematics"},
    "no delay": {"vehicle_model_type": "kinematics_no_delay"},
    "dynamics": {"vehicle_model_type": "dynamics"} | DYNAMICS,
}
