# SPDX-License-Identifier: Apache-2.0
"""Routines that a compiler expects of its environment, as LLVM IR, to be put inside an object.

A 32-bit processor has no instruction for 64-bit division or for conversion between 64-bit integers
and double precision, and LLVM turns loops that shift an array into calls of ``memmove``. Toolchains
differ in what they bring, so an object brings its own, hidden from the rest of a program.
"""

from __future__ import annotations

from collections.abc import Iterable

from safety_island.targets.aot.machines import Machine
from safety_island.targets.aot.support_arithmetic import ARITHMETIC

_MOVE = """
define ptr @memmove(ptr %to, ptr %from, %word %size) {
entry:
  %a = ptrtoint ptr %to to %word
  %b = ptrtoint ptr %from to %word
  %ab = or %word %a, %b
  %abn = or %word %ab, %size
  %odd = and %word %abn, 3
  %by_four = icmp eq %word %odd, 0
  %unit = select i1 %by_four, %word 4, %word 1
  %forward = icmp ule %word %a, %b
  %last = sub %word %size, %unit
  %start = select i1 %forward, %word 0, %word %last
  %back = sub %word 0, %unit
  %stride = select i1 %forward, %word %unit, %word %back
  %is_empty = icmp eq %word %size, 0
  br i1 %is_empty, label %done, label %loop
loop:
  %moved = phi %word [ 0, %entry ], [ %moved_next, %next ]
  %place = phi %word [ %start, %entry ], [ %place_next, %next ]
  %source = getelementptr i8, ptr %from, %word %place
  %target = getelementptr i8, ptr %to, %word %place
  br i1 %by_four, label %four, label %one
four:
  %w = load i32, ptr %source, align 4
  store i32 %w, ptr %target, align 4
  br label %next
one:
  %c = load i8, ptr %source, align 1
  store i8 %c, ptr %target, align 1
  br label %next
next:
  %moved_next = add %word %moved, %unit
  %place_next = add %word %place, %stride
  %is_last = icmp eq %word %moved_next, %size
  br i1 %is_last, label %done, label %loop
done:
  ret ptr %to
}
"""
"""Forwards or backwards; four bytes at a time where addresses and size allow it."""

_DECLARED = {
    "memmove": "declare ptr @memmove(ptr, ptr, i32)",
    "memcpy": "declare ptr @memcpy(ptr, ptr, i32)",
    "memset": "declare ptr @memset(ptr, i32, i32)",
}
_FORWARDED = {
    "__aeabi_memmove": ("ptr %a, ptr %b, i32 %n", "memmove(ptr %a, ptr %b, i32 %n)"),
    "__aeabi_memcpy": ("ptr %a, ptr %b, i32 %n", "memcpy(ptr %a, ptr %b, i32 %n)"),
    "__aeabi_memset": ("ptr %a, i32 %n, i32 %c", "memset(ptr %a, i32 %c, i32 %n)"),
    "__aeabi_memclr": ("ptr %a, i32 %n", "memset(ptr %a, i32 0, i32 %n)"),
}
"""Section 4.3.4 of the run-time ABI: each also with 4 or 8 behind its name, for aligned memory."""


def _forward(name: str, kind: str) -> str:
    taken, called = _FORWARDED[kind]
    body = f"  %unused = call ptr @{called}\n  ret void"
    declared = _DECLARED[called.partition("(")[0]]
    return f"{declared}\ndefine arm_aapcscc void @{name}({taken}) {{\n{body}\n}}\n"


def _table(machine: Machine) -> dict[str, str]:
    """Every routine for a machine, by name; none for a hosted one, whose C library has them."""
    if machine.is_host:
        return {}
    move = {"memmove": _MOVE.replace("%word", "i64" if machine.is_64_bit else "i32")}
    if machine.is_64_bit:
        return move
    memory = {
        f"{kind}{size}": _forward(f"{kind}{size}", kind)
        for kind in _FORWARDED
        for size in ("", "4", "8")
    }
    return move | memory | ARITHMETIC


def routines_for(machine: Machine, undefined: Iterable[str]) -> dict[str, str]:
    """Return the IR of those undefined symbols that are routines, by name.

    One that calls another of them brings it along.
    """
    table = _table(machine)
    found = {name: table[name] for name in sorted(undefined) if name in table}
    if any(name.startswith("__aeabi_memmove") for name in found):
        found["memmove"] = table["memmove"]
    return found
