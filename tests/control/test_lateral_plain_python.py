# SPDX-License-Identifier: Apache-2.0
"""The lateral kernels and the gate as plain Python: the same tests, and no warning."""

from __future__ import annotations

import pytest

from safety_island.control.kernel import JIT
from tests.control.test_longitudinal_plain_python import HERE, run_plain

FILES = (
    *("lateral", "lateral_standing", "mpc", "mpc_acceptance", "filters", "steering_offset"),
    *("steering_rate_limit", "vehicle_model", "input_check", "spline", "reference_shape"),
)


@pytest.mark.skipif(not JIT, reason="this process runs plain Python already")
@pytest.mark.timeout(600)  # some 15 s on an idle machine
def test_the_same_tests_pass_without_compilation() -> None:
    result = run_plain(*(str(HERE / f"test_{name}.py") for name in FILES))
    assert result.returncode == 0, result.stdout[-4000:] + result.stderr[-1000:]
    assert " passed" in result.stdout and "skipped" not in result.stdout
