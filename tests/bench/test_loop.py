# SPDX-License-Identifier: Apache-2.0
"""``island bench loop``: a short live measurement, and what it refuses."""

import json
import subprocess
import sys

import pytest

PROGRAM = (sys.executable, "-m", "safety_island", "bench", "loop")


@pytest.mark.live
def test_times_of_both_ways_are_measured() -> None:
    done = subprocess.run(
        [*PROGRAM, "--duration", "4", "--json"], capture_output=True, text=True, timeout=100
    )
    assert done.returncode == 0, done.stderr
    times = json.loads(done.stdout)
    assert times["commands"] >= 5
    assert 0.0 < times["in_median_us"] <= times["in_p99_us"]
    assert 0.0 < times["out_median_us"] <= times["out_p99_us"]
    assert times["total_median_us"] == times["in_median_us"] + times["out_median_us"]


def test_a_measurement_without_end_is_refused() -> None:
    done = subprocess.run([*PROGRAM, "--duration", "0"], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1
    assert "name the seconds to measure" in done.stderr
