# SPDX-License-Identifier: Apache-2.0
"""No multiplication is fused with an addition: it would round once where other machines do twice.

x86-64 needs no look: the processor that its library is made for has no such instruction.
"""

from __future__ import annotations

import pytest

from safety_island.targets.aot.codegen import compile_object
from safety_island.targets.aot.machines import AARCH64, CORTEX_R52, CORTEX_R82, X86_64, Machine
from safety_island.targets.aot.objects import kernel_objects
from tests.targets.aot.fused import fused

ARM = [AARCH64, CORTEX_R82, CORTEX_R52]
pytestmark = pytest.mark.timeout(600)  # the first of a session compiles the kernels

IR = """
define i32 @kernel.sums(ptr %result, ptr %exception, double %a, double %b, double %c) {
  FUSED
  %is_more = fcmp ogt double %sum, %c
  %status = zext i1 %is_more to i32
  store i32 %status, ptr %result
  ret i32 0
}
declare double @llvm.fma.f64(double, double, double)
declare double @llvm.fmuladd.f64(double, double, double)
"""
FUSED = {
    "asked for": "%sum = call double @llvm.fma.f64(double %a, double %b, double %c)",
    "allowed": "%sum = call double @llvm.fmuladd.f64(double %a, double %b, double %c)",
    "contracted": "%p = fmul contract double %a, %b\n  %sum = fadd contract double %p, %c",
    "negative": (
        "%n = fneg double %a\n  %sum = call double @llvm.fma.f64(double %n, double %b, double %c)"
    ),
}
SEPARATE = "%p = fmul double %a, %b\n  %sum = fadd double %p, %c"


def count(body: str, machine: Machine) -> int:
    ir = IR.replace("FUSED", body)
    return fused(compile_object("sums", ir, (float, float, float), machine))


@pytest.mark.parametrize("machine", ARM, ids=lambda machine: machine.name)
def test_a_fused_instruction_is_seen_and_a_plain_product_and_sum_stay_apart(
    machine: Machine,
) -> None:
    assert {name: count(body, machine) for name, body in FUSED.items()} == dict.fromkeys(FUSED, 1)
    assert count(SEPARATE, machine) == 0


@pytest.mark.slow
@pytest.mark.parametrize("machine", ARM, ids=lambda machine: machine.name)
def test_no_kernel_fuses_a_multiplication_with_an_addition(machine: Machine) -> None:
    found = {
        item.name: fused(item.data)
        for item in kernel_objects(machine, lambda name, index, n: None, on_demand=True)
    }
    assert len(found) > 5
    assert set(found.values()) == {0}, found


def test_the_processor_of_the_library_for_x86_64_has_none() -> None:
    assert X86_64.cpu == "x86-64-v2"
