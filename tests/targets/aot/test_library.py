# SPDX-License-Identifier: Apache-2.0
"""Kernels taken from a library: the same bits, no compiler, refusals that a user understands."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from safety_island.control.input_check import check_trajectory
from safety_island.control.limits import MAX_POINTS
from safety_island.control.records import PARAMS, POINT, pack_parameters
from safety_island.control.status import Refusal
from safety_island.errors import ConfigurationError
from safety_island.kernel import kernel
from safety_island.kernel import library as libraries
from safety_island.kernel.library import LIBRARY_NAME, VARIABLE, Library
from safety_island.params import load_set

ROOT = Path(__file__).parents[3]
COMPILED = os.environ | {"PYTHONPATH": f"{ROOT / 'src'}:{ROOT}"}
pytestmark = pytest.mark.timeout(600)  # the first of a session compiles the kernels


@pytest.fixture(scope="session")
def library(posix_build: Path) -> Path:
    """The library of a build for this machine."""
    return posix_build / LIBRARY_NAME


def fingerprint(environment: dict[str, str]) -> dict[str, Any]:
    result = subprocess.run(
        [sys.executable, "-m", "tests.targets.aot.fingerprint"],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 0, result.stderr[-2000:]
    found: dict[str, Any] = json.loads(result.stdout)
    return found


@pytest.mark.slow
@pytest.mark.skipif(not kernel.JIT, reason="compares with kernels that are compiled in process")
def test_every_golden_run_gives_the_same_bits_without_a_compiler(library: Path) -> None:
    ahead = fingerprint(COMPILED | {VARIABLE: str(library)})
    in_process = fingerprint(COMPILED)
    assert ahead["compilers"] == []
    assert in_process["compilers"] == ["numba", "llvmlite"]
    assert len(ahead["runs"]) > 50
    assert ahead["runs"] == in_process["runs"]


def check(library: Path) -> Any:
    return Library(library).function(check_trajectory.name, check_trajectory.arguments)


def test_a_kernel_is_called_with_records_and_numbers(library: Path) -> None:
    call, params = check(library), pack_parameters(load_set("default"))
    points = np.zeros(MAX_POINTS, POINT)
    points["qw"] = 1.0
    points["x"] = np.arange(MAX_POINTS)
    assert call(params, points, 5, 0.0) == Refusal.ACCEPTED
    assert call(params, points, np.int64(1), 0.0) == Refusal.TOO_FEW_POINTS
    points["x"][3] = np.nan
    assert call(params, points, 5, 0.0) == Refusal.NOT_FINITE


def test_an_array_is_looked_at_again_when_its_place_in_memory_is_taken_by_another(
    library: Path,
) -> None:
    call, params = check(library), pack_parameters(load_set("default"))
    for _ in range(50):
        points = np.zeros(4, POINT)
        points["qw"] = 1.0
        points["x"] = np.arange(4)
        assert call(params, points, 4, 0.0) == Refusal.ACCEPTED
        del points
        wrong = np.zeros(4, PARAMS)
        with pytest.raises(TypeError, match="argument 2"):
            call(params, wrong, 4, 0.0)


READ_ONLY = np.zeros(4, POINT)
READ_ONLY.flags.writeable = False


@pytest.mark.parametrize(
    "points",
    [
        None,
        np.zeros(4),
        np.zeros(4, PARAMS),
        np.zeros((2, 2), POINT),
        np.zeros(0, POINT),
        np.zeros(8, POINT)[::2],
        READ_ONLY,
    ],
    ids=["none", "numbers", "other records", "2-D", "empty", "strided", "read-only"],
)
def test_what_is_no_record_array_is_refused_before_the_kernel_runs(
    library: Path, points: Any
) -> None:
    call, params = check(library), pack_parameters(load_set("default"))
    with pytest.raises(TypeError, match="check_trajectory: argument 2"):
        call(params, points, 2, 0.0)
    with pytest.raises((TypeError, ValueError)):
        call(params)
    with pytest.raises(TypeError):
        call(params, np.zeros(4, POINT), 2.5, 0.0)


def test_a_kernel_that_the_library_has_not_is_named(library: Path) -> None:
    with pytest.raises(ConfigurationError, match=r"no kernel 'lateral_prepare'.*osqp"):
        Library(library).function("lateral_prepare", ())


def test_a_library_of_other_sources_is_refused(
    library: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(libraries, "sources_hash", lambda: "0" * 64)
    with pytest.raises(ConfigurationError, match="made from other kernel sources"):
        Library(library)


@pytest.mark.parametrize("content", [None, b"", b"\x7fELF" + bytes(60)])
def test_a_file_that_is_no_library_is_refused(tmp_path: Path, content: bytes | None) -> None:
    path = tmp_path / "kernels.so"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(ConfigurationError, match=f"^{re.escape(str(path))}: not a library"):
        Library(path)


def test_a_library_of_something_else_is_refused() -> None:
    import _ctypes

    with pytest.raises(ConfigurationError, match="not a library of control kernels"):
        Library(Path(_ctypes.__file__))


def test_the_environment_names_the_library_and_plain_python_wins(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    assert libraries.find_library() is None
    monkeypatch.setenv(VARIABLE, str(tmp_path / "a.so"))
    assert libraries.find_library() == tmp_path / "a.so"
    code = "from safety_island.kernel.kernel import JIT, LIBRARY; print(JIT, LIBRARY)"
    environment = COMPILED | {VARIABLE: "/nowhere.so", "SAFETY_ISLAND_JIT": "0"}
    said = subprocess.check_output([sys.executable, "-c", code], env=environment, text=True)
    assert said.split() == ["False", "None"]


def test_a_wrong_library_ends_a_command_with_one_line(tmp_path: Path) -> None:
    result = subprocess.run(
        [sys.executable, "-m", "safety_island", "run", "--platform", "sim", "--duration", "1"],
        env=COMPILED | {VARIABLE: str(tmp_path / "missing.so")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 2
    (error,) = [line for line in result.stderr.splitlines() if "error" in line]
    assert "missing.so: not a library" in error
