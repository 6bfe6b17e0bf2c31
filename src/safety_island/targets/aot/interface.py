# SPDX-License-Identifier: Apache-2.0
"""The C function around a kernel, in LLVM IR."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from safety_island.control.limits import MAX_POINTS
from safety_island.control.records import POINT
from safety_island.input_gate.clock.records import MAX_INPUTS, STAMPS
from safety_island.kernel.library import PREFIX
from safety_island.targets.aot.ir import NATIVE
from safety_island.targets.errors import BuildError

RAISED = "kernel.raised"
"""Called where a kernel has raised an exception: it exists nowhere."""

_ARRAY = ("ptr", "ptr", "i64", "i64", "ptr", "i64", "i64")
"""How Numba passes an array: owner (2), count, item size, data, shape, stride."""
_SCALARS: dict[Any, str] = {float: "double", int: "i64"}


def record_count(argument: Any) -> int:
    """Return how many records an argument holds at least, as far as a kernel may reach."""
    return MAX_INPUTS if argument == STAMPS else MAX_POINTS if argument == POINT else 1


def check_signature(function: Any, arguments: Sequence[Any]) -> None:
    """Raise BuildError unless a function takes its arguments as this module passes them."""
    expected = ["ptr", "ptr"]
    for argument in arguments:
        expected += [_SCALARS[argument]] if argument in _SCALARS else _ARRAY
    found = [str(argument.type) for argument in function.arguments]
    if found != expected:
        raise BuildError(f"{function.name}: Numba passes {found}, expected {expected}")


def interface_ir(name: str, arguments: Sequence[Any]) -> str:
    """Return the IR of the C function: a pointer for each record array, numbers, the status back.

    Numba's own outcome says whether an exception was raised. An optimiser that can prove that none
    is leaves no trace of RAISED; with any other kernel it stays an undefined symbol.
    """
    taken, passed, types = [], ["ptr %result", "ptr %exception"], ["ptr", "ptr"]
    for index, argument in enumerate(arguments):
        kind = _SCALARS.get(argument, "ptr")
        taken.append(f"{kind} %a{index}")
        if argument in _SCALARS:
            passed.append(f"{kind} %a{index}")
            types.append(kind)
            continue
        count, size = record_count(argument), argument.itemsize
        passed += ["ptr null", "ptr null", f"i64 {count}", f"i64 {size}"]
        passed += [f"ptr %a{index}", f"i64 {count}", f"i64 {size}"]
        types += _ARRAY
    native = f'@"{NATIVE}{name}"'
    return f"""
declare i32 {native}({", ".join(types)})
define i32 @{PREFIX}{name}({", ".join(taken)}) {{
  %result = alloca i32
  %exception = alloca ptr
  store i32 0, ptr %result
  %outcome = call i32 {native}({", ".join(passed)})
  %is_fine = icmp eq i32 %outcome, 0
  br i1 %is_fine, label %fine, label %raised
fine:
  %status = load i32, ptr %result
  ret i32 %status
raised:
  call void @{RAISED}()
  unreachable
}}
declare void @{RAISED}()
"""
