# SPDX-License-Identifier: Apache-2.0
"""How kernels are compiled: fixed types, no memory of their own, plain Python on request."""

from __future__ import annotations

import fcntl
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from safety_island.control.follower import TrajectoryFollower
from safety_island.control.input_check import check_trajectory
from safety_island.control.records import INPUTS, PARAMS, POINT, new_points, pack_parameters
from safety_island.control.status import Refusal
from safety_island.kernel import kernel
from safety_island.kernel.records import Records
from tests.control.lateral_rig import line
from tests.golden.harness import firmware

pytestmark = pytest.mark.timeout(600)  # the first of a session compiles the kernels
SOURCES = Path(kernel.__file__).parents[2]
needs_jit = pytest.mark.skipif(not kernel.JIT, reason="kernels are not compiled in this process")


def good() -> list[Any]:
    points = new_points()
    points[:21] = line(20.0)
    return [pack_parameters(firmware()), points, 21, 0.0]


def frozen(values: Records) -> Records:
    values = values.copy()
    values.flags.writeable = False
    return values


def test_an_entry_takes_what_it_was_declared_with() -> None:
    check_trajectory.prepare()
    assert check_trajectory.call(*good()) == Refusal.ACCEPTED
    assert check_trajectory.arguments == (PARAMS, POINT, int, float)


WRONG = [
    pytest.param(0, np.zeros(1, INPUTS), id="record"),
    pytest.param(0, np.zeros((1, 1), PARAMS), id="shape"),
    pytest.param(1, frozen(new_points()), id="read-only"),
    pytest.param(1, new_points()[::2], id="strided"),
    pytest.param(1, np.zeros((9, 11)), id="numbers"),
    pytest.param(1, None, id="none"),
]
"""Place of an argument, and what does not fit there."""


@needs_jit
@pytest.mark.parametrize(
    ("index", "argument"),
    [*WRONG, pytest.param(2, "21", id="text"), pytest.param(2, np.arange(3), id="array")],
)
def test_any_other_type_is_a_type_error_and_no_compilation(index: int, argument: Any) -> None:
    check_trajectory.prepare()
    arguments = good()
    arguments[index] = argument
    dispatcher: Any = check_trajectory.call
    before = dispatcher.signatures[:]
    with pytest.raises(TypeError):
        check_trajectory.call(*arguments)
    assert dispatcher.signatures == before and len(before) == 1


@pytest.mark.parametrize(
    ("index", "argument"), [*WRONG, pytest.param(1, new_points()[:0], id="empty")]
)
def test_only_what_the_kernel_can_take_is_bound(index: int, argument: Any) -> None:
    arrays = good()[:2]
    arrays[index] = argument
    with pytest.raises(TypeError, match=f"check_trajectory: argument {index + 1} "):
        check_trajectory.bind(*arrays)


def test_a_bound_kernel_does_the_same() -> None:
    params, points, count, start = good()
    check = check_trajectory.bind(params, points)
    assert (
        check(count, start)
        == check_trajectory.call(params, points, count, start)
        == Refusal.ACCEPTED
    )
    points["x"][3] = np.nan
    assert (
        check(count, start)
        == check_trajectory.call(params, points, count, start)
        == Refusal.NOT_FINITE
    )


@needs_jit
def test_a_number_is_converted_and_not_compiled_for() -> None:
    """Numba converts an int to the float that was declared."""
    follower = TrajectoryFollower(firmware())
    follower.offer_trajectory(line(20.0), 1000)
    follower.offer_odometry(0, 0, 0, 0, 0, 0, 1, 1, 0, 0)
    follower.offer_steering(0)
    follower.offer_acceleration(0)
    follower.offer_operation_mode(2, True)
    assert follower.step(1000)
    assert [len(item.call.signatures) for item in prepared()] == [1] * len(prepared())


def prepared() -> list[Any]:
    return [item for item in kernel.ENTRIES if item.call is not item.python]


@needs_jit
def test_preparing_twice_changes_nothing() -> None:
    check_trajectory.prepare()
    before = check_trajectory.call
    check_trajectory.prepare()
    assert check_trajectory.call is before


@needs_jit
def test_a_kernel_that_allocates_does_not_compile() -> None:
    import numba

    @kernel.kernel
    def sums(n: int) -> float:
        values = np.zeros(n)
        values[0] = 1.0
        return float(values.sum())

    with pytest.raises(numba.errors.NumbaError):
        sums(3)


@needs_jit
def test_a_kernel_may_look_at_parts_of_what_it_was_given() -> None:
    @kernel.kernel
    def middle(values: Any) -> Any:
        part = values[1:3]
        part[0] = 7.0
        return part[1]

    values = np.arange(4.0)
    assert middle(values) == 2.0 and values[1] == 7.0


def test_every_kernel_of_a_tick_is_prepared_in_order_and_told() -> None:
    told: list[tuple[str, int, int]] = []
    kernel.prepare(lambda *told_of: told.append(told_of))
    assert [index for _, index, _ in told] == list(range(len(kernel.ENTRIES)))
    assert {count for _, _, count in told} == {len(kernel.ENTRIES)}
    names = [name for name, _, _ in told]
    assert {"check_trajectory", "lateral_step", "longitudinal_step"} <= set(names)
    assert not {item.name for item in kernel.ON_DEMAND} & set(names)


def python(code: str, **environment: str) -> list[str]:
    """Run Python on the sources in a process of its own; return the words that it prints."""
    result = subprocess.run(
        [sys.executable, "-c", code],
        env=os.environ | {"PYTHONPATH": str(SOURCES)} | environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 0, result.stderr
    return result.stdout.split()


@needs_jit
def test_compiled_code_is_found_on_disk(tmp_path: Path) -> None:
    kernel.prepare()
    assert kernel.is_cached()
    code = (
        "import safety_island.control.follower; from safety_island.kernel import kernel;"
        "print(kernel.is_cached())"
    )
    assert python(code, SAFETY_ISLAND_CACHE=str(tmp_path)) == ["False"]
    assert python(code, SAFETY_ISLAND_CACHE=str(kernel.cache_folder().parent)) == ["True"]


LOAD = """
from safety_island.control.input_check import check_trajectory
check_trajectory.prepare()
cache = check_trajectory.call._cache
hits, misses = (sum(s.values()) for s in (check_trajectory.call.stats.cache_hits,
                                          check_trajectory.call.stats.cache_misses))
print(hits, misses, check_trajectory.is_on_disk())
"""
"""Prints how often compiled code was loaded and compiled, and whether it is kept."""


@pytest.fixture
def kept(tmp_path: Path) -> Path:
    """A cache of its own that holds one kernel."""
    check_trajectory.prepare()
    target = tmp_path / kernel.cache_folder().name
    target.mkdir(mode=0o700)
    for file in kernel.cache_folder().glob("*check_trajectory*"):
        shutil.copy(file, target)
    return target


@needs_jit
def test_row_90_code_that_is_there_is_loaded_though_another_process_holds_the_lock(
    kept: Path,
) -> None:
    """One that stands still in the middle of a compilation kept every later start waiting."""
    with (kept / "check_trajectory.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        assert python(LOAD, SAFETY_ISLAND_CACHE=str(kept.parent)) == ["1", "0", "True"]


@needs_jit
@pytest.mark.slow
def test_code_that_is_missing_is_compiled_at_once_though_another_holds_the_lock(
    tmp_path: Path,
) -> None:
    folder = tmp_path / kernel.cache_folder().name
    folder.mkdir(mode=0o700)
    with (folder / "check_trajectory.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        assert python(LOAD, SAFETY_ISLAND_CACHE=str(tmp_path))[2:] == ["False"]


@needs_jit
@pytest.mark.slow
@pytest.mark.parametrize("ending", ["nbi", "nbc"])
def test_a_damaged_file_is_made_anew(kept: Path, ending: str) -> None:
    """What a power failure leaves."""
    (file,) = kept.glob(f"*.{ending}")
    file.write_bytes(file.read_bytes()[:40])
    found = python(LOAD, SAFETY_ISLAND_CACHE=str(kept.parent))
    assert found[2] == "True"
    assert python(LOAD, SAFETY_ISLAND_CACHE=str(kept.parent)) == ["1", "0", "True"]


@needs_jit
@pytest.mark.skipif(os.geteuid() != 0, reason="becomes another user, as only root may")
def test_code_in_a_folder_of_root_that_cannot_be_written_is_loaded(tmp_path: Path) -> None:
    """As in an image that was prepared when it was made. A user without rights asks."""
    code = (
        "import os; from safety_island.kernel import kernel, cache as c;"
        "os.setgid(4242); os.setuid(4242); c.place.cache_clear();"
        "print(c.place().folder, kernel.is_kept(), c.place().note == '')"
    )
    with tempfile.TemporaryDirectory(prefix="island-", dir="/var/tmp") as root:
        Path(root).chmod(0o755)
        folder = Path(root) / kernel.cache_folder().name
        folder.mkdir(mode=0o755)
        (folder / "some.nbi").touch()
        assert python(code, SAFETY_ISLAND_CACHE=root) == [str(folder), "False", "True"]


@needs_jit
def test_code_for_another_processor_does_not_count_as_there(kept: Path) -> None:
    code = (
        "from safety_island.control.input_check import check_trajectory as c; print(c.is_on_disk())"
    )
    place = {"SAFETY_ISLAND_CACHE": str(kept.parent)}
    assert python(code, **place) == ["True"]
    assert python(code, NUMBA_CPU_NAME="generic", **place) == ["False"]


def test_plain_python_needs_no_compiler() -> None:
    """``SAFETY_ISLAND_JIT=0``: the same functions, and Numba is not even imported."""
    code = (
        "import sys; import safety_island.control.follower as f;"
        "from safety_island.kernel import kernel;"
        "from safety_island.params import load_set;"
        "f.TrajectoryFollower(load_set('default'));"
        "note = kernel.cache_note() == '';"
        "print(kernel.JIT, kernel.is_cached(), 'numba' in sys.modules,"
        "all(e.call is e.python for e in kernel.ENTRIES), note)"
    )
    assert python(code, SAFETY_ISLAND_JIT="0") == ["False", "True", "False", "True", "True"]


def test_a_kernel_of_a_test_is_not_one_of_the_island() -> None:
    """A start, a build and the cache would look for its code where there is none."""

    @kernel.entry(float)
    def mine(number: Any) -> Any:
        return int(number)

    assert mine not in kernel.ENTRIES + kernel.ON_DEMAND
