# SPDX-License-Identifier: Apache-2.0
"""From the LLVM IR of a kernel to an object file for one machine, with a plain C interface."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

import llvmlite.binding as llvm

from safety_island.kernel.library import PREFIX, SOURCES
from safety_island.targets.aot.elf import read_elf
from safety_island.targets.aot.interface import RAISED, check_signature, interface_ir
from safety_island.targets.aot.ir import NATIVE
from safety_island.targets.aot.machines import Machine
from safety_island.targets.aot.names import shorten
from safety_island.targets.aot.support_routines import routines_for
from safety_island.targets.errors import BuildError


@cache
def _initialize() -> None:
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()


def target_machine(machine: Machine) -> Any:
    """Return LLVM's description of a machine."""
    _initialize()
    reloc = "pic" if machine.is_host else "static"
    target = llvm.Target.from_triple(machine.triple)
    return target.create_target_machine(machine.cpu, "", opt=3, reloc=reloc, codemodel="default")


def compile_object(name: str, ir: str, arguments: Sequence[Any], machine: Machine) -> bytes:
    """Return an object file that defines ``safety_island_<name>`` and nothing else.

    Raises BuildError for a kernel that may raise an exception.
    """
    maker = target_machine(machine)
    module = llvm.parse_assembly(ir)
    check_signature(module.get_function(NATIVE + name), arguments)
    module.link_in(llvm.parse_assembly(interface_ir(name, arguments)))
    _close(module, PREFIX + name)
    _optimize(module, maker, machine)
    if any(function.name == RAISED for function in module.functions):
        raise BuildError(f"the kernel '{name}' may raise an exception, which no target can take")
    shorten(module)
    return _emit(module, maker, machine)


def sources_object(sources_hash: str, machine: Machine) -> bytes:
    """Return an object file that tells the hash of the kernel sources."""
    text = f'@{SOURCES} = constant [{len(sources_hash) + 1} x i8] c"{sources_hash}\\00"\n'
    maker = target_machine(machine)
    return _emit(_for_machine(llvm.parse_assembly(text), maker), maker, machine)


def _close(module: Any, visible: str) -> None:
    """Hide everything but the named function."""
    for item in (*module.functions, *module.global_variables):
        if not item.is_declaration and item.name != visible:
            item.linkage = "internal"


def _for_machine(module: Any, maker: Any) -> Any:
    module.triple = maker.triple
    module.data_layout = str(maker.target_data)
    return module


def _optimize(module: Any, maker: Any, machine: Machine) -> None:
    _for_machine(module, maker)
    options = llvm.create_pipeline_tuning_options(speed_level=3)
    options.loop_vectorization = options.slp_vectorization = machine.vectorize
    builder = llvm.create_pass_builder(maker, options)
    builder.getModulePassManager().run(module, builder)


def _emit(module: Any, maker: Any, machine: Machine) -> bytes:
    """Emit an object; what a compiler expects of its environment is put inside it."""
    _forbid_unwinding(module)
    code: bytes = maker.emit_object(module.clone())
    undefined = read_elf(code).undefined
    routines = routines_for(machine, undefined)
    if not routines:
        return code
    for text in routines.values():
        module.link_in(_for_machine(llvm.parse_assembly(text), maker))
    for name in routines:
        module.get_function(name).linkage = "internal"
    _forbid_unwinding(module)
    complete: bytes = maker.emit_object(module)
    return complete


def _forbid_unwinding(module: Any) -> None:
    """Leave unwind tables out: nothing is thrown, and they would name a routine of C++."""
    for function in module.functions:
        if not function.is_declaration:
            function.add_function_attribute("nounwind")
