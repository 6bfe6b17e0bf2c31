# SPDX-License-Identifier: Apache-2.0
"""The maths functions give the same bits as plain Python, compiled, and on other processors."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from safety_island.kernel.kernel import JIT
from safety_island.targets.aot.codegen import compile_object
from safety_island.targets.aot.compile import ENVIRONMENT
from safety_island.targets.aot.elf import read_elf
from safety_island.targets.aot.linker import find_compiler
from safety_island.targets.aot.machines import AARCH64, CORTEX_R52, Machine, host
from tests.kernel.math.functions import CALL, CALL_ALL, ENTRY, arguments, digest

ROOT = Path(__file__).parents[3]
MODULE = "tests.kernel.math.functions"
pytestmark = pytest.mark.timeout(600)

MAIN = """
int safety_island_call_all(void *calls, long long n);
long read(int file, void *to, unsigned long size);
long write(int file, const void *from, unsigned long size);
static char calls[COUNT * SIZE] __attribute__((aligned(8)));
int main(void) {
  for (long done = 0, n; done < sizeof calls; done += n)
    if ((n = read(0, calls + done, sizeof calls - done)) <= 0) return 1;
  if (safety_island_call_all(calls, COUNT)) return 2;
  for (long done = 0, n; done < sizeof calls; done += n)
    if ((n = write(1, calls + done, sizeof calls - done)) <= 0) return 3;
  return 0;
}
"""
WITHOUT_A_C_LIBRARY = """
int main(void);
static long call(long number, long a, long b, long c) {
  register long r7 __asm__("r7") = number;
  register long r0 __asm__("r0") = a;
  register long r1 __asm__("r1") = b;
  register long r2 __asm__("r2") = c;
  __asm__ volatile("svc 0" : "+r"(r0) : "r"(r7), "r"(r1), "r"(r2) : "memory");
  return r0;
}
long read(int file, void *to, unsigned long size) { return call(3, file, (long)to, size); }
long write(int file, const void *from, unsigned long size) {
  return call(4, file, (long)from, size);
}
void _start(void) { call(1, main(), 0, 0); }
void *memset(void *to, int value, unsigned long size) {
  for (volatile char *c = to; size--;) *c++ = value;
  return to;
}
void *memcpy(void *to, const void *from, unsigned long size) {
  const char *next = from;
  for (volatile char *c = to; size--;) *c++ = *next++;
  return to;
}
"""
"""What a program for 32-bit Arm needs, by Linux' own calls, so that no library must be built."""


def in_a_process(*words: str, **environment: str) -> str:
    """Run the module of the functions; return what it prints."""
    path = {"PYTHONPATH": os.pathsep.join([str(ROOT / "src"), *map(str, sys.path)])}
    return subprocess.check_output(
        [sys.executable, "-m", MODULE, *words],
        cwd=ROOT,
        env=os.environ | path | environment,
        text=True,
    )


@pytest.fixture(scope="module")
def expected() -> str:
    """The hash of every bit, as this process runs kernels."""
    calls = arguments()
    assert CALL_ALL(calls, len(calls)) == 0
    return digest(calls)


@pytest.mark.skipif(not JIT, reason="this process runs plain Python already")
def test_plain_python_gives_the_bits_of_compiled_code(expected: str) -> None:
    assert in_a_process(SAFETY_ISLAND_JIT="0").split() == [expected]


@pytest.fixture(scope="module")
def ir() -> str:
    """LLVM IR of all functions, for no particular machine."""
    return in_a_process("ir", **ENVIRONMENT)


def test_no_function_needs_a_maths_library(ir: str) -> None:
    for machine in (host(), AARCH64, CORTEX_R52):
        undefined = read_elf(compile_object(ENTRY.name, ir, ENTRY.arguments, machine)).undefined
        assert set(undefined) <= {"memcpy", "memset"}, machine.name


def values_of(folder: Path, ir: str, machine: Machine, link: list[str], run: list[str]) -> str:
    """Link a program around the functions, run it, and return the hash of its values."""
    calls = arguments()
    (folder / "main.c").write_text(MAIN if machine.is_host else MAIN + WITHOUT_A_C_LIBRARY)
    code = compile_object(ENTRY.name, ir, ENTRY.arguments, machine)
    (folder / "functions.o").write_bytes(code)
    size = [f"-DCOUNT={len(calls)}", f"-DSIZE={calls.itemsize}"]
    command = [*link, *size, "-static", "-o", "program", "main.c", "functions.o"]
    subprocess.run(command, cwd=folder, check=True)
    program = [*run, str(folder / "program")]
    said = subprocess.check_output(program, input=calls.tobytes())
    return digest(np.frombuffer(said, CALL))


def test_a_library_for_this_machine_gives_the_same_bits(
    tmp_path: Path, ir: str, expected: str
) -> None:
    compiler = find_compiler()
    assert compiler is not None
    assert values_of(tmp_path, ir, host(), list(compiler.command), []) == expected


@pytest.mark.skipif(
    not shutil.which("qemu-aarch64") or not shutil.which("aarch64-linux-gnu-gcc"),
    reason="no emulator of aarch64 (qemu-user), or no compiler for it (gcc-aarch64-linux-gnu)",
)
def test_aarch64_gives_the_same_bits(tmp_path: Path, ir: str, expected: str) -> None:
    link = ["aarch64-linux-gnu-gcc"]
    assert values_of(tmp_path, ir, AARCH64, link, ["qemu-aarch64"]) == expected


@pytest.mark.skipif(
    not shutil.which("qemu-arm") or find_spec("ziglang") is None,
    reason="no emulator of Arm (qemu-user), or no compiler for it (the package ziglang)",
)
def test_the_cortex_r52_gives_the_same_bits(tmp_path: Path, ir: str, expected: str) -> None:
    zig = [sys.executable, "-m", "ziglang", "cc", "-target", "arm-linux-musleabihf"]
    link = [*zig, "-nostdlib", "-fno-sanitize=all", "-fno-builtin"]
    assert values_of(tmp_path, ir, CORTEX_R52, link, ["qemu-arm", "-cpu", "max"]) == expected
