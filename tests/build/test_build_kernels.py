# SPDX-License-Identifier: Apache-2.0
"""Compiling kernels: what does not compile is named with its cause, and twice gives the same."""

from __future__ import annotations

import fcntl
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm
import numpy as np
import pytest

from safety_island.build import kernel_compile, kernel_ir
from safety_island.build.c_layout import check_layout
from safety_island.build.codegen import compile_object
from safety_island.build.errors import BuildError
from safety_island.build.kernel_compile import compile_into, kernel_irs
from safety_island.build.kernel_objects import kernel_objects
from safety_island.build.machines import CORTEX_R52, X86_64, host
from safety_island.control.records import POINT
from safety_island.kernel import kernel
from safety_island.kernel.records import record

pytestmark = pytest.mark.timeout(600)  # the first of a session compiles the kernels

RAISES = """
@.const.picklebuf.1 = internal constant i32 0
define i32 @kernel.bad(ptr %result, ptr %exception, i64 %n) {
  %is_wrong = icmp sgt i64 %n, 3
  br i1 %is_wrong, label %wrong, label %right
wrong:
  store ptr @.const.picklebuf.1, ptr %exception
  ret i32 1
right:
  store i32 0, ptr %result
  ret i32 0
}
"""


def quiet(name: str, index: int, count: int) -> None:
    """Report nothing."""


@pytest.mark.slow
def test_the_same_sources_give_the_same_bytes(tmp_path: Path) -> None:
    names = ["check_trajectory", "longitudinal_step"]
    compile_into(tmp_path, names, quiet)
    known = {item.name: item.data for item in kernel_objects(host(), quiet)}
    entries = {entry.name: entry for entry in kernel.ENTRIES}
    for name in names:
        ir = (tmp_path / f"{name}.ll").read_text()
        assert compile_object(name, ir, entries[name].arguments, host()) == known[name]
        assert str(Path.cwd()).encode() not in known[name]


def test_a_kernel_that_may_raise_is_refused() -> None:
    with pytest.raises(BuildError, match="'bad' may raise an exception"):
        compile_object("bad", RAISES, (int,), X86_64)


def test_a_kernel_that_numba_would_call_differently_is_refused() -> None:
    with pytest.raises(BuildError, match=r"Numba passes .*expected"):
        compile_object("bad", RAISES, (float,), X86_64)


@pytest.mark.skipif(not kernel.JIT, reason="needs the compiler")
def test_the_cause_of_a_failed_compilation_is_one_line(tmp_path: Path) -> None:
    @kernel.kernel
    def allocate(point: Any) -> Any:
        memory = np.zeros(3)
        return memory[0] + point.x

    def bad(points: Any, n: Any) -> Any:
        return int(allocate(points[n]))

    entry = kernel.Entry(bad, (POINT, int), True)
    with pytest.raises(Exception, match="zeros") as caught:
        kernel_ir.ir_of(entry)
    text = kernel_ir.essence(str(caught.value))
    assert "\n" not in text
    assert "np.zeros" not in text
    assert f"({Path(__file__).name}:" in text


def test_a_kernel_that_does_not_compile_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = tmp_path / "failing.py"
    program.write_text(
        "import sys\nprint('lateral_step', flush=True)\n"
        "print('TypingError: no such thing (mpc.py:7)', file=sys.stderr)\nsys.exit(1)\n"
    )
    monkeypatch.setattr(kernel_compile, "COMPILER", [str(program)])
    reported: list[str] = []
    with pytest.raises(BuildError, match=r"'lateral_step' cannot be compiled: .*\(mpc\.py:7\)"):
        compile_into(
            tmp_path / "ir",
            ["check_trajectory", "lateral_step"],
            lambda name, index, count: reported.append(f"{name} {index} {count}"),
        )
    assert reported == ["lateral_step 1 2"]
    assert list((tmp_path / "ir").iterdir()) == []


def test_kernels_are_compiled_once() -> None:
    kernel_irs(quiet)
    again: list[str] = []
    irs = kernel_irs(lambda name, index, count: again.append(name))
    assert again == []
    for name, ir in irs.items():
        assert f"@kernel.{name}(" in ir
        llvm.parse_assembly(ir)


def test_a_build_that_finds_another_one_at_work_says_so_and_ends_at_a_limit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It waited for ever, without a word."""
    monkeypatch.setattr(kernel_compile, "ir_folder", lambda: tmp_path)
    monkeypatch.setattr(kernel_compile, "LOCK_LIMIT_S", 0.5)
    told: list[str] = []
    with (tmp_path / "lock").open("w") as other:
        fcntl.flock(other, fcntl.LOCK_EX)
        with pytest.raises(BuildError, match=r"another process holds .*/lock for more than 0.5 s"):
            kernel_irs(lambda name, index, count: told.append(name))
    assert told == ["what another build compiles (at most 0.5 s)"]


def test_a_lock_file_that_is_a_link_is_not_opened(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(kernel_compile, "ir_folder", lambda: tmp_path)
    victim = tmp_path / "victim"
    victim.write_text("precious")
    (tmp_path / "lock").symlink_to(victim)
    with pytest.raises(OSError, match="symbolic links"):
        kernel_irs(quiet)
    assert victim.read_text() == "precious"


def test_a_record_that_a_machine_lays_out_differently_is_refused() -> None:
    packed = np.dtype([("a", "?"), ("b", "f8")])  # nine bytes, as no C compiler has it
    aligned = record([("a", "?"), ("b", "f8")])
    check_layout([aligned], CORTEX_R52)
    with pytest.raises(BuildError, match=r"cortex-r52 lays out the record \(a, b, \.\.\.\).*'b'"):
        check_layout([packed], CORTEX_R52)
