# SPDX-License-Identifier: Apache-2.0
"""Checks, without a C compiler, that a machine lays records out as NumPy does."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from llvmlite import ir

from safety_island.targets.aot.codegen import target_machine
from safety_island.targets.aot.machines import Machine
from safety_island.targets.errors import BuildError
from safety_island.targets.headers.records import fields_of


def check_layout(dtypes: Iterable[Any], machine: Machine) -> None:
    """Raise BuildError for a record that the machine's C compilers would lay out differently."""
    layout = target_machine(machine).target_data
    for dtype in dtypes:
        structure = _type(dtype)
        places = [structure.get_element_offset(layout, i) for i in range(len(dtype.names))]
        expected = [offset for _, _, offset in fields_of(dtype)]
        size = structure.get_abi_size(layout)
        if places != expected or size != dtype.itemsize:
            differing = [n for n, a, b in zip(dtype.names, places, expected, strict=True) if a != b]
            where = f"field '{differing[0]}'" if differing else f"{size} bytes in all"
            raise BuildError(
                f"{machine.name} lays out the record ({dtype.names[0]}, {dtype.names[1]}, ...) "
                f"of {dtype.itemsize} bytes differently: {where}"
            )


def _type(dtype: Any) -> Any:
    """The LLVM type; a bool takes a byte."""
    if dtype.subdtype:
        base, shape = dtype.subdtype
        found = _type(base)
        for size in reversed(shape):
            found = ir.ArrayType(found, size)
        return found
    if dtype.names:
        return ir.LiteralStructType([_type(kind) for _, kind, _ in fields_of(dtype)])
    if dtype.kind == "f":
        return ir.DoubleType() if dtype.itemsize == 8 else ir.FloatType()
    return ir.IntType(8 * dtype.itemsize)
