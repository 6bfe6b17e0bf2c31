# SPDX-License-Identifier: Apache-2.0
"""LLVM IR of the control kernels: compiled once for the sources at hand, then taken from disk.

The IR is for no particular machine, so every target shares it.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from typing import IO

from safety_island.kernel import kernel
from safety_island.kernel.entries import all_entries
from safety_island.package import PACKAGE
from safety_island.targets.aot import ir as kernel_ir
from safety_island.targets.errors import BuildError

Report = Callable[[str, int, int], None]
"""Told the name of a kernel, its index and the count, before it is compiled."""

ENVIRONMENT = {
    "NUMBA_CPU_NAME": "generic",
    "NUMBA_CPU_FEATURES": "",
    "NUMBA_OPT": "0",  # optimised later, for the machine
    "PYTHONHASHSEED": "0",  # the same sources give the same bytes
    "SAFETY_ISLAND_JIT": "1",  # an installed platform wheel has a library already
}
LOCK_LIMIT_S, LOCK_POLL_S = 600.0, 0.2
"""Longest wait [s] for another process that compiles the same, and between two looks."""
COMPILER = ["-m", kernel_ir.__name__]
"""What Python runs to compile."""
_OURS = ("NUMBA_", "SAFETY_ISLAND_KERNELS", "SAFETY_ISLAND_JIT")


def entries(on_demand: bool = False) -> list[kernel.Entry]:
    """Return the kernels that a library holds, in an order that no import decides.

    ``on_demand``: also those that only the solver OSQP needs.
    """
    return sorted(all_entries(on_demand), key=lambda entry: entry.name)


def kernel_irs(report: Report, on_demand: bool = False) -> dict[str, str]:
    """Return the IR of ``entries`` by name. Raises BuildError for one that does not compile."""
    folder = ir_folder()
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    names = [entry.name for entry in entries(on_demand)]
    with _locked(folder, report):
        missing = [name for name in names if not (folder / f"{name}.ll").exists()]
        if missing:
            compile_into(folder, missing, report)
    return {name: (folder / f"{name}.ll").read_text(encoding="utf-8") for name in names}


def ir_folder() -> Path:
    """Return the folder, named after all that the IR depends on."""
    digest = hashlib.sha256(Path(kernel_ir.__file__).read_bytes())
    digest.update(f"{version('llvmlite')} {sys.version_info[:2]} {ENVIRONMENT}".encode())
    return kernel.cache_folder() / f"ir-{digest.hexdigest()[:16]}"


def compile_into(folder: Path, names: list[str], report: Report) -> None:
    """Compile the named entries into files; nothing half done is left under a final name."""
    unfinished = folder / f"unfinished-{os.getpid()}"
    unfinished.mkdir(parents=True)
    command = [sys.executable, *COMPILER, str(unfinished), *names]
    try:
        with subprocess.Popen(
            command,
            env=_environment(),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        ) as process:
            current = _follow(process, names, report)
            _, errors = process.communicate()
        if process.returncode:
            why = (errors.strip().splitlines() or ["the compiler ended without a word"])[-1]
            raise BuildError(f"the kernel '{current}' cannot be compiled: {why}")
        for name in names:
            (unfinished / f"{name}.ll").rename(folder / f"{name}.ll")
    finally:
        for rest in unfinished.iterdir():
            rest.unlink()
        unfinished.rmdir()


def _follow(process: subprocess.Popen[str], names: list[str], report: Report) -> str:
    """Pass on the progress; return the name of the kernel that was worked on last."""
    assert process.stdout is not None
    current = names[0]
    for line in process.stdout:
        word = line.strip()
        if word in names:
            current = word
            report(word, names.index(word), len(names))
    return current


def _environment() -> dict[str, str]:
    kept = {k: v for k, v in os.environ.items() if not k.startswith(_OURS)}
    root = str(PACKAGE.parent)
    return kept | ENVIRONMENT | {"PYTHONPATH": root}


@contextmanager
def _locked(folder: Path, report: Report) -> Iterator[None]:
    """Let one process compile; the next one says so, waits within a limit, and finds the result."""
    descriptor = os.open(folder / "lock", os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o600)
    with os.fdopen(descriptor, "w") as lock:
        end = time.monotonic() + LOCK_LIMIT_S
        is_told = False
        while not _take(lock):
            if time.monotonic() > end:
                raise BuildError(
                    f"another process holds {folder}/lock for more than {LOCK_LIMIT_S:g} s: end it "
                    f"(fuser -v {folder}/lock), or set SAFETY_ISLAND_CACHE to another folder"
                )
            if not is_told:
                report(f"what another build compiles (at most {LOCK_LIMIT_S:g} s)", 0, 1)
                is_told = True
            time.sleep(LOCK_POLL_S)
        yield


def _take(lock: IO[str]) -> bool:
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True
