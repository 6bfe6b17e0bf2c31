# SPDX-License-Identifier: Apache-2.0
"""A platform wheel: the package with a library of compiled kernels inside.

The library is called through ctypes and needs the C library alone, so one wheel for each processor
serves every version of Python, and its users need no compiler.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

from safety_island.extras import require
from safety_island.kernel.library import LIBRARY_NAME
from safety_island.targets.aot.elf import shared_needs
from safety_island.targets.aot.linker import GLIBC, ZIG, link_shared, needed_compiler
from safety_island.targets.aot.machines import Machine
from safety_island.targets.aot.objects import kernel_objects
from safety_island.targets.errors import BuildError
from safety_island.targets.package.revision import source_tree

Say = Callable[[str], None]
"""Told each step, in words."""

_LIBRARIES = {"libc.so.6"}
_VARIABLES = ("SAFETY_ISLAND_WHEEL_LIBRARY", "SAFETY_ISLAND_WHEEL_TAG")
"""How tools/hatch_hooks.py is told the library and the tag."""


def build_wheel(machine: Machine, folder: Path, say: Say) -> Path:
    """Make the wheel for a machine in ``folder``; return its path.

    Raises BuildError outside a source tree, or when the library is not as the tag promises.
    """
    root = source_tree()
    if root is None or find_spec("hatchling") is None:
        raise BuildError("a wheel is made in a clone, by its .venv (./island dev)")
    require("compile", "island build --wheel")
    needed_compiler(machine)  # told now, not after a minute
    with TemporaryDirectory() as scratch:
        library = _library(machine, Path(scratch), say)
        values = (str(library), tag(machine))
        say("wheel")
        made = _pack(root, Path(scratch), dict(zip(_VARIABLES, values, strict=True)))
        folder.mkdir(parents=True, exist_ok=True)
        return Path(shutil.move(made, folder / made.name))


def tag(machine: Machine) -> str:
    """Return the platform tag (PEP 600): any Linux of that processor with glibc ``GLIBC``."""
    return f"manylinux_{GLIBC.replace('.', '_')}_{machine.name}"


def check_portable(data: bytes, machine: Machine) -> None:
    """Raise BuildError for a library that needs more than the tag of its wheel promises."""
    baseline = _number(f"GLIBC_{GLIBC}")
    for library, versions in shared_needs(data).items():
        if library not in _LIBRARIES and not library.startswith("ld-linux"):
            raise BuildError(f"the library of kernels needs {library}; a wheel must not")
        newer = sorted(version for version in versions if _number(version) > baseline)
        if newer:
            raise BuildError(
                f"the library of kernels needs {', '.join(newer)} of {library}, newer than "
                f"{tag(machine)} promises; link it where glibc is {GLIBC} or older, or with zig "
                f"alone (remove cc from PATH; .venv/bin/python -m pip install {ZIG})"
            )


def _library(machine: Machine, folder: Path, say: Say) -> Path:
    say(f"control kernels for {machine.name}")
    files = []
    for item in kernel_objects(
        machine, lambda name, i, n: say(f"  kernel {i + 1} of {n}: {name}"), on_demand=True
    ):
        files.append(folder / f"{item.name}.o")
        files[-1].write_bytes(item.data)
    say(f"shared library {LIBRARY_NAME}")
    library = folder / LIBRARY_NAME
    link_shared(files, library, machine)
    check_portable(library.read_bytes(), machine)
    return library


def _pack(root: Path, folder: Path, variables: dict[str, str]) -> Path:
    """Let hatchling make the wheel in an empty folder; return its path."""
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    done = subprocess.run(
        command,
        cwd=root,
        env=os.environ | variables,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        said = done.stderr.strip().splitlines() or ["hatchling gave no reason"]
        raise BuildError(f"the wheel cannot be made: {said[-1]}")
    (made,) = folder.glob("*.whl")
    return made


def _number(version: str) -> tuple[int, ...]:
    """``GLIBC_2.31`` as numbers; what is no such name counts as newer than all."""
    kind, _, digits = version.partition("_")
    parts = digits.split(".")
    if kind != "GLIBC" or not all(part.isdigit() for part in parts):
        return (sys.maxsize,)
    return tuple(map(int, parts))
