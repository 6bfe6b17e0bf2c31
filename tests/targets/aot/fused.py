# SPDX-License-Identifier: Apache-2.0
"""Finds instructions that multiply and add with one rounding in the code of an Arm object file."""

from __future__ import annotations

from io import BytesIO
from typing import Any

import numpy as np
import numpy.typing as npt
from elftools.elf.elffile import ELFFile

Words = npt.NDArray[np.uint32]

_FUSED: dict[str, list[tuple[int, int]]] = {
    "EM_AARCH64": [
        (0xFF000000, 0x1F000000),  # FMADD, FMSUB, FNMADD, FNMSUB
        (0xBF20FC00, 0x0E20CC00),  # FMLA of vectors; FMLS differs in bit 23
        (0xBF80B400, 0x0F801000),  # FMLA, FMLS by an element
    ],
    "EM_ARM": [
        (0x0FB00E10, 0x0EA00A00),  # VFMA, VFMS
        (0x0FB00E10, 0x0E900A00),  # VFNMA, VFNMS
        (0xFF800F10, 0xF2000C10),  # VFMA, VFMS of vectors
    ],
}
"""Mask and value of each (Arm Architecture Reference Manual, A64 and A32)."""


def fused(data: bytes) -> int:
    """Return how many such instructions the code of an object file has."""
    file: Any = ELFFile(BytesIO(data))
    patterns = _FUSED[file.header.e_machine]
    return sum(
        int(np.count_nonzero((words & np.uint32(mask)) == np.uint32(value)))
        for words in _code(file)
        for mask, value in patterns
    )


def _code(file: Any) -> list[Words]:
    """Return the instructions; constants between them ($d) are left out."""
    marks: dict[int, list[tuple[int, bool]]] = {}
    for symbol in file.get_section_by_name(".symtab").iter_symbols():
        kind = symbol.name.split(".")[0]
        if kind in ("$a", "$x", "$d"):
            place = (int(symbol["st_value"]), kind != "$d")
            marks.setdefault(symbol["st_shndx"], []).append(place)
    found = []
    for index, places in marks.items():
        data = file.get_section(index).data()
        places.sort()
        ends = [start for start, _ in places[1:]] + [len(data)]
        for (start, is_code), end in zip(places, ends, strict=True):
            if is_code:
                found.append(np.frombuffer(data[start : end - (end - start) % 4], "<u4"))
    return found
