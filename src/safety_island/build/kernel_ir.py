# SPDX-License-Identifier: Apache-2.0
"""Compiles the control kernels to LLVM IR, in a process of its own: ``python -m`` this module.

Numba reads its settings once, so they must be in the environment before the process starts
(``kernel_compile.ENVIRONMENT``): IR for no particular machine, not optimised yet. Each entry
becomes a file ``<name>.ll`` in the folder that is given; its name is printed before.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

NATIVE = "kernel."
"""The kernel with Numba's own signature has this before its name."""

_PLACE = re.compile(r'^File "(.+)", line (\d+):', re.MULTILINE)


def main(folder: Path, names: list[str]) -> int:
    """Compile the named entries (all without names); 1 when one cannot be compiled."""
    from safety_island.kernel.entries import all_entries

    for entry in all_entries(on_demand=True):
        if names and entry.name not in names:
            continue
        print(entry.name, flush=True)
        try:
            text = ir_of(entry)
        except Exception as error:  # whatever the compiler says is what a user must read
            print(f"{type(error).__name__}: {essence(str(error))}", file=sys.stderr)
            return 1
        (folder / f"{entry.name}.ll").write_text(text, encoding="utf-8")
    return 0


def ir_of(entry: Any) -> str:
    """Return the IR of an entry whose function is ``kernel.<name>`` and whose result is int32."""
    import llvmlite.binding as llvm
    import numba

    from safety_island.kernel.kernel import FLAGS

    signature = numba.int32(*entry.signature())
    options: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    njit: Any = numba.njit
    dispatcher = njit(signature, **FLAGS, **options)(entry.python)
    (compiled,) = dispatcher.overloads.values()
    module = llvm.parse_assembly(compiled.library.get_llvm_str())
    module.get_function(compiled.fndesc.mangled_name).name = NATIVE + entry.name
    return str(module)


def essence(message: str) -> str:
    """Return the cause in a long message of Numba, and the innermost place in our own source."""
    lines = [line.strip() for line in message.splitlines() if line.strip()]
    rest = [line for line in lines if not line.startswith("Failed in ")] or ["no reason was given"]
    cause = " ".join(rest[:2]) if rest[0].endswith(":") else rest[0]
    place = _PLACE.search(message)
    return f"{cause} ({Path(place[1]).name}:{place[2]})" if place else cause


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), sys.argv[2:]))
