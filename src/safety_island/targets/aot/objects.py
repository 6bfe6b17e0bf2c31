# SPDX-License-Identifier: Apache-2.0
"""Object files of the control kernels for one machine, kept on disk beside their LLVM IR."""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass
from pathlib import Path

from safety_island.kernel.sources import sources_hash
from safety_island.targets.aot.compile import Report, entries, ir_folder, kernel_irs
from safety_island.targets.aot.elf import ElfFile, read_elf
from safety_island.targets.aot.machines import Machine
from safety_island.targets.errors import BuildError

SOURCES = "sources"
"""The object that tells the hash of the kernel sources."""

ALLOWED = {"memcpy", "memset"}
"""What an object may leave undefined: no function of a maths library, whose values differ."""
_HOST_ALLOWED = ALLOWED | {"memmove"}


@dataclass(frozen=True)
class KernelObject:
    """One object file; ``name`` is that of the kernel."""

    name: str
    data: bytes
    elf: ElfFile


def kernel_objects(machine: Machine, report: Report, on_demand: bool = False) -> list[KernelObject]:
    """Return the objects for a machine: each kernel's, then that of the source hash.

    ``report`` is told each kernel that is compiled; ``on_demand`` as in ``entries``. Raises
    BuildError with kernel, machine and why.
    """
    irs = kernel_irs(report, on_demand)
    folder = _folder(machine)
    folder.mkdir(parents=True, exist_ok=True)
    found = []
    for index, name in enumerate((*irs, SOURCES)):
        path = folder / f"{name}.o"
        if not path.exists():
            if name in irs:
                report(f"{name} for {machine.name}", index, len(irs))
            _write(path, _compile(name, irs.get(name, ""), machine))
        data = path.read_bytes()
        found.append(_checked(KernelObject(name, data, read_elf(data, path.name)), machine))
    return found


def _compile(name: str, ir: str, machine: Machine) -> bytes:
    from safety_island.targets.aot.codegen import compile_object, sources_object

    try:
        if name == SOURCES:
            return sources_object(sources_hash(), machine)
        (entry,) = (entry for entry in entries(on_demand=True) if entry.name == name)
        return compile_object(name, ir, entry.arguments, machine)
    except RuntimeError as error:  # what LLVM refuses
        why = " ".join(str(error).split())
        raise BuildError(f"'{name}' cannot be compiled for {machine.name}: {why}") from None


def _checked(item: KernelObject, machine: Machine) -> KernelObject:
    allowed = _HOST_ALLOWED if machine.is_host else ALLOWED
    if item.elf.machine != machine.elf_machine:
        raise BuildError(f"'{item.name}' came out for {item.elf.machine}, not {machine.name}")
    strange = [symbol for symbol in item.elf.undefined if symbol not in allowed]
    if strange:
        raise BuildError(
            f"'{item.name}' for {machine.name} needs {', '.join(strange)}; "
            f"only {', '.join(sorted(allowed))} may be left undefined"
        )
    return item


def _folder(machine: Machine) -> Path:
    digest = hashlib.sha256()
    for source in sorted(Path(__file__).parent.glob("*.py")):  # all that decides of the code
        digest.update(source.read_bytes())
    return ir_folder() / f"{machine.name}-{digest.hexdigest()[:16]}"


def _write(path: Path, data: bytes) -> None:
    unfinished = path.with_suffix(f".{os.getpid()}")
    unfinished.write_bytes(data)
    unfinished.rename(path)
