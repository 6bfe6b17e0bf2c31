# SPDX-License-Identifier: Apache-2.0
"""What is made for the two Arm boards: objects without strange symbols, archive, header."""

from __future__ import annotations

import json
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from safety_island.control.status import Refusal
from safety_island.kernel.library import LIBRARY_NAME
from safety_island.targets.aot.compile import entries
from safety_island.targets.aot.elf import read_elf
from safety_island.targets.aot.linker import check_header, find_compiler
from safety_island.targets.aot.machines import BOARDS, CORTEX_R52, X86_64
from safety_island.targets.aot.objects import ALLOWED, KernelObject, _checked
from safety_island.targets.errors import BuildError
from safety_island.targets.kconfig.targets import TARGETS
from safety_island.targets.package.pipeline import ARCHIVE_NAME
from safety_island.targets.package.products import UNIT_TEST

KERNELS = tuple(entry.name for entry in entries())
FUNCTIONS = tuple(f"safety_island_{name}" for name in KERNELS)
BOARD_TARGETS = [target.name for target in TARGETS if target.board in BOARDS]
pytestmark = pytest.mark.timeout(600)  # the first of a session compiles the kernels


@pytest.fixture(params=BOARD_TARGETS)
def board_build(request: pytest.FixtureRequest, build_of: Callable[[str], Path]) -> Path:
    """The folder of a build for a board."""
    return build_of(request.param)


def test_every_kernel_is_an_object_that_needs_memcpy_and_memset_alone(board_build: Path) -> None:
    manifest = json.loads((board_build / "manifest.json").read_text())
    assert set(manifest["kernels"]) == {*KERNELS, "sources"}
    assert set(manifest["undefined_symbols"]) <= ALLOWED
    assert sorted(ALLOWED) == ["memcpy", "memset"]
    for name, told in manifest["kernels"].items():
        data = (board_build / "objects" / f"{name}.o").read_bytes()
        elf = read_elf(data)
        assert elf.machine in ("EM_ARM", "EM_AARCH64")
        assert elf.defined == (f"safety_island_{name}",)
        assert set(elf.undefined) <= ALLOWED
        assert (told["size"], told["text"]) == (len(data), elf.text)
        assert elf.text > 0
        assert elf.data == elf.bss == 0


def test_the_archive_holds_the_objects_and_says_what_they_define(board_build: Path) -> None:
    data = (board_build / ARCHIVE_NAME).read_bytes()
    assert data.startswith(b"!<arch>\n")
    for name in KERNELS:
        assert (board_build / "objects" / f"{name}.o").read_bytes() in data
    ar, nm = shutil.which("ar"), shutil.which("nm")
    if ar is None or nm is None:
        pytest.skip("no binutils to read it with")
    listed = subprocess.check_output([ar, "t", str(board_build / ARCHIVE_NAME)], text=True)
    assert listed.split() == [f"{name}.o" for name in (*KERNELS, "sources")]
    index = subprocess.check_output([nm, "-s", str(board_build / ARCHIVE_NAME)], text=True)
    for function in FUNCTIONS:
        assert f"{function} in {function.removeprefix('safety_island_')}.o" in index


def test_floating_point_is_passed_in_registers_on_the_cortex_r52(
    build_of: Callable[[str], Path],
) -> None:
    folder = build_of("s32z270dc2_rtu0_r52@D")
    data = (folder / "objects" / "lateral_step.o").read_bytes()
    start = data.index(b"aeabi\0")
    attributes = data[start : start + 80]
    assert b"cortex-r52\0" in attributes
    assert bytes([28, 1]) in attributes  # Tag_ABI_VFP_args: VFP registers


def test_the_headers_are_read_by_a_c_compiler(board_build: Path) -> None:
    if find_compiler() is None:
        pytest.skip("no C compiler")
    for header in sorted((board_build / "include").glob("*.h")):
        check_header(header)
    text = (board_build / "include" / "safety_island_control.h").read_text()
    assert "_Static_assert" in text
    for function in FUNCTIONS:
        assert f"int32_t {function}(" in text


PROGRAM = """
#include "safety_island_control.h"
#include "safety_island_messages.h"
static struct safety_island_params params;
static struct safety_island_point points[SAFETY_ISLAND_MAX_POINTS];
static struct safety_island_guard_params limits;
static struct safety_island_guard_state guard;
static struct safety_island_guard_proposal proposal;
static struct safety_island_guard_decision decision;

int main(void) {
  params.traj_resample_dist = 0.1;
  for (int i = 0; i < 5; i++) {
    points[i].x = i;
    points[i].qw = 1.0;
  }
  for (int i = 0; i < 65; i++)
    if (safety_island_sources[i] != SAFETY_ISLAND_SOURCES[i]) return 100;
  int32_t refusal = safety_island_check_trajectory(&params, points, 1, 0.0);
  if (refusal != SAFETY_ISLAND_REFUSAL_TOO_FEW_POINTS) return 101;
  proposal.now = 1.0;
  int32_t verdict = safety_island_guard_command(&limits, &guard, &proposal, &decision);
  if (verdict != SAFETY_ISLAND_VERDICT_REFUSED) return 102;
  if (decision.limits != SAFETY_ISLAND_LIMIT_STALE) return 103;
  return safety_island_check_trajectory(&params, points, 5, 0.0);
}
"""


def test_a_c_program_calls_the_kernels(posix_build: Path, tmp_path: Path) -> None:
    compiler = find_compiler()
    assert compiler is not None, "the build for this machine needed one"
    source, program = tmp_path / "program.c", tmp_path / "program"
    source.write_text(PROGRAM)
    library = posix_build / LIBRARY_NAME
    flags = ["-I", str(posix_build / "include"), f"-Wl,-rpath,{posix_build}"]
    command = [*compiler.command, "-o", str(program), str(source), str(library), *flags]
    subprocess.run(command, check=True)
    assert subprocess.run([str(program)], check=False).returncode == Refusal.ACCEPTED


def test_a_wrong_layout_is_told_by_the_c_compiler(board_build: Path, tmp_path: Path) -> None:
    if find_compiler() is None:
        pytest.skip("no C compiler")
    text = (board_build / "include" / "safety_island_control.h").read_text()
    wrong = tmp_path / "wrong.h"
    wrong.write_text(text.replace("  float velocity;", "  double velocity;", 1))
    with pytest.raises(BuildError, match=r"wrong\.h is not right: .*safety_island_command"):
        check_header(wrong)


def test_an_object_that_needs_more_is_refused_by_name(board_build: Path) -> None:
    data = (board_build / "objects" / "check_trajectory.o").read_bytes()
    elf = read_elf(data)
    machine = CORTEX_R52._replace(elf_machine=elf.machine)
    strange = KernelObject("check_trajectory", data, replace(elf, undefined=("malloc",)))
    with pytest.raises(BuildError, match="'check_trajectory' for cortex-r52 needs malloc"):
        _checked(strange, machine)
    with pytest.raises(BuildError, match=r"came out for EM_\w+, not x86_64"):
        _checked(KernelObject("check_trajectory", data, elf), X86_64)


def test_a_board_runs_no_test_program(build_of: Callable[..., Path]) -> None:
    with pytest.raises(BuildError, match=r"--unit-test: .*runs no Python"):
        build_of("fvp_baser_aemv8r_smp", UNIT_TEST)


@pytest.mark.parametrize("data", [b"", b"\x7fELF", b"\x7fELF\2\1" + bytes(20), b"MZ" + bytes(100)])
def test_what_is_no_elf_file_is_refused(data: bytes) -> None:
    with pytest.raises(BuildError, match=r"x\.o: not an ELF file, or a damaged one"):
        read_elf(data, "x.o")
