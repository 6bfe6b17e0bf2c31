# SPDX-License-Identifier: Apache-2.0
"""Routines that stand in for instructions a 32-bit processor lacks, run on this one."""

from __future__ import annotations

import ctypes as ct
import math
from collections.abc import Iterator
from typing import Any

import llvmlite.binding as llvm
import pytest
from hypothesis import given
from hypothesis import strategies as st

from safety_island.targets.aot.machines import CORTEX_R52, CORTEX_R82, X86_64
from safety_island.targets.aot.support_arithmetic import ARITHMETIC
from safety_island.targets.aot.support_routines import routines_for

SIGNED = st.integers(-(2**63), 2**63 - 1)
UNSIGNED = st.integers(0, 2**64 - 1) | st.integers(0, 2**33)
NUMBERS = st.floats(allow_nan=True, allow_infinity=True) | SIGNED.map(float)
_ENGINES: list[Any] = []


class Pair(ct.Structure):
    """Quotient and remainder."""

    _fields_ = (("quotient", ct.c_uint64), ("remainder", ct.c_uint64))


def compiled(text: str, name: str, result: Any, *arguments: Any) -> Any:
    """Return a routine as machine code of this machine, with its ordinary calling convention."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    machine = llvm.Target.from_default_triple().create_target_machine()
    module = llvm.parse_assembly(text.replace("arm_aapcscc ", ""))
    engine = llvm.create_mcjit_compiler(module, machine)
    engine.finalize_object()
    _ENGINES.append(engine)
    return ct.CFUNCTYPE(result, *arguments)(engine.get_function_address(name))


def arithmetic(name: str, result: Any, *arguments: Any) -> Any:
    return compiled(ARITHMETIC[name], name, result, *arguments)


DIVIDE = arithmetic("__aeabi_ldivmod", Pair, ct.c_int64, ct.c_int64)
DIVIDE_UNSIGNED = arithmetic("__aeabi_uldivmod", Pair, ct.c_uint64, ct.c_uint64)
TO_DOUBLE = arithmetic("__aeabi_l2d", ct.c_double, ct.c_int64)
TO_DOUBLE_UNSIGNED = arithmetic("__aeabi_ul2d", ct.c_double, ct.c_uint64)
TO_INTEGER = arithmetic("__aeabi_d2lz", ct.c_int64, ct.c_double)


@given(UNSIGNED, UNSIGNED)
def test_unsigned_division(n: int, d: int) -> None:
    found = DIVIDE_UNSIGNED(n, d)
    assert (found.quotient, found.remainder) == (divmod(n, d) if d else (0, n))


@given(SIGNED, SIGNED | st.integers(-9, 9))
def test_signed_division_is_cut_towards_zero(n: int, d: int) -> None:
    found = DIVIDE(n, d)
    quotient = abs(n) // abs(d) * (1 if (n < 0) == (d < 0) else -1) if d else 0
    assert found.quotient == quotient % 2**64
    assert found.remainder == (n - quotient * d) % 2**64


@given(SIGNED, UNSIGNED)
def test_an_integer_becomes_the_nearest_double(signed: int, unsigned: int) -> None:
    assert TO_DOUBLE(signed) == float(signed)
    assert TO_DOUBLE_UNSIGNED(unsigned) == float(unsigned)


@given(NUMBERS)
def test_a_double_is_cut_towards_zero_and_what_does_not_fit_is_the_least_integer(x: float) -> None:
    fits = math.isfinite(x) and abs(x) < 2.0**63
    assert TO_INTEGER(x) == (math.trunc(x) if fits else -(2**63))


@pytest.fixture(scope="module")
def move() -> Iterator[Any]:
    """The routine that moves memory, of a 64-bit processor."""
    text = routines_for(CORTEX_R82, ["memmove"])["memmove"].replace("@memmove", "@move")
    yield compiled(text, "move", ct.c_void_p, ct.c_void_p, ct.c_void_p, ct.c_int64)


@pytest.mark.parametrize("size", [0, 1, 3, 4, 8, 40, 41])
@pytest.mark.parametrize(("source", "target"), [(0, 8), (8, 0), (0, 1), (1, 0), (4, 4), (0, 64)])
def test_memory_is_moved_although_it_overlaps(
    move: Any, size: int, source: int, target: int
) -> None:
    memory = bytearray(range(128))
    expected = bytearray(memory)
    expected[target : target + size] = expected[source : source + size]
    buffer = (ct.c_char * 128).from_buffer(memory)
    address = ct.addressof(buffer)
    assert move(address + target, address + source, size) == address + target
    assert memory == expected


def test_each_machine_gets_what_it_lacks() -> None:
    wanted = ["__aeabi_memmove8", "__aeabi_l2d", "memmove", "sin"]
    assert routines_for(X86_64, wanted) == {}
    assert set(routines_for(CORTEX_R82, wanted)) == {"memmove"}
    assert set(routines_for(CORTEX_R52, wanted)) == set(wanted) - {"sin"}
    assert set(routines_for(CORTEX_R52, ["__aeabi_memmove"])) == {"__aeabi_memmove", "memmove"}
