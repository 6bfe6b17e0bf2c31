# SPDX-License-Identifier: Apache-2.0
"""Links object files to a shared library, with the C compiler at hand."""

from __future__ import annotations

import platform
import shutil
import subprocess
import sys
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from safety_island.targets.aot.machines import Machine
from safety_island.targets.errors import BuildError

ZIG = "ziglang==0.17.0"
"""The package that brings a C compiler where the machine has none."""
GLIBC = "2.31"
"""The oldest C library that a library runs with: Debian 11, Ubuntu 20.04, every JetPack since 5."""
_FLAGS = (
    "-shared",
    "-nostartfiles",
    "-Wl,--build-id=none",
    "-Wl,--gc-sections",
    "-Wl,--no-undefined",
    "-Wl,-z,noexecstack",
    "-Wl,-z,relro",
    "-Wl,-z,now",
)


_CROSS = {
    "aarch64": "gcc-aarch64-linux-gnu libc6-dev-arm64-cross",
    "x86_64": "gcc-x86-64-linux-gnu libc6-dev-amd64-cross",
}
"""Debian's packages that bring a compiler for another machine."""


class Compiler(NamedTuple):
    """How a C compiler is called, and which one it is."""

    command: tuple[str, ...]
    name: str


def find_compiler(machine: Machine | None = None) -> Compiler | None:
    """Return ``cc``, else zig of the package ``ziglang``, None without both.

    For a machine that is not this one: the cross compiler of that name in place of ``cc``.
    """
    is_other = machine is not None and machine.name != platform.machine()
    path = shutil.which(f"{machine.name}-linux-gnu-gcc" if machine and is_other else "cc")
    if path is not None:
        return Compiler((path,), _said_by(path))
    if find_spec("ziglang") is not None:
        try:
            return Compiler((sys.executable, "-m", "ziglang", "cc"), f"zig {version('ziglang')}")
        except PackageNotFoundError:
            return None
    return None


def needed_compiler(machine: Machine | None = None) -> Compiler:
    """Return the compiler. Raises BuildError that says how to get one."""
    found = find_compiler(machine)
    if found is not None:
        return found
    debian = "gcc libc6-dev"
    if machine is not None and machine.name != platform.machine():
        debian = _CROSS.get(machine.name, debian)
    raise BuildError(
        f"no C compiler to link with: install one (on Debian: sudo apt-get install {debian}) "
        f"or run: .venv/bin/python -m pip install {ZIG}"
    )


def link_shared(objects: Sequence[Path], output: Path, machine: Machine) -> str:
    """Link objects to a shared library; return the name of the linker.

    Raises BuildError with the linker's own words.
    """
    compiler = needed_compiler(machine)
    files = [str(path) for path in objects]
    name = f"-Wl,-soname,{output.name}"
    command = [*compiler.command, *_FLAGS, name, "-o", str(output), *files]
    if compiler.name.startswith("zig"):
        command += ["-target", f"{machine.triple.replace('-unknown', '')}.{GLIBC}", "-s"]
    else:
        command += ["-Wl,--strip-all"]
    _run(command, f"{output.name} cannot be linked")
    return compiler.name


def check_header(header: Path) -> str | None:
    """Let a C compiler read a header, its assertions included; None when there is none.

    Returns the compiler's name. Raises BuildError with its own words.
    """
    compiler = find_compiler()
    if compiler is None:
        return None
    flags = ["-std=c11", "-Wall", "-Wextra", "-Werror", "-x", "c", "-c", str(header), "-o"]
    with TemporaryDirectory() as folder:  # zig must write an object, even when only asked to read
        command = [*compiler.command, *flags, f"{folder}/header.o"]
        _run(command, f"{header.name} is not right")
    return compiler.name


def _run(command: list[str], failure: str) -> None:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        said = (done.stderr or done.stdout).strip().splitlines()
        errors = [line for line in said if "error" in line] or said or ["no reason was given"]
        raise BuildError(f"{failure}: {errors[0].strip()}")


def _said_by(path: str) -> str:
    """The first line of ``cc --version``: program and version."""
    done = subprocess.run([path, "--version"], capture_output=True, text=True, check=False)
    return done.stdout.partition("\n")[0].strip() or "cc"
