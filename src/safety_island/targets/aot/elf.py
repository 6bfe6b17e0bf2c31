# SPDX-License-Identifier: Apache-2.0
"""What a build must know of an object file: symbols, sizes, processor."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from typing import Any

from elftools.common.exceptions import ELFError
from elftools.elf.constants import SH_FLAGS
from elftools.elf.elffile import ELFFile

from safety_island.targets.errors import BuildError


@dataclass(frozen=True)
class ElfFile:
    """What is in an object file; sizes in bytes."""

    machine: str
    """``EM_ARM``, for example."""
    defined: tuple[str, ...]
    """Symbols that others can use, sorted."""
    undefined: tuple[str, ...]
    """Symbols that others must bring, sorted."""
    text: int
    """Code and constants."""
    data: int
    bss: int


def read_elf(data: bytes, name: str = "object file") -> ElfFile:
    """Read an object file. Raises BuildError when it is none."""
    try:
        file = ELFFile(BytesIO(data))
        symbols = list(_symbols(file))
        return ElfFile(
            file.header.e_machine,
            tuple(sorted(name for name, is_defined in symbols if is_defined)),
            tuple(sorted(name for name, is_defined in symbols if not is_defined)),
            *_sizes(file),
        )
    except (ELFError, AttributeError, OverflowError) as error:  # what damage leads to
        raise BuildError(f"{name}: not an ELF file, or a damaged one: {error}") from None


def shared_needs(data: bytes) -> dict[str, frozenset[str]]:
    """Return the libraries that a shared library needs, and which versions of their symbols."""
    file: Any = ELFFile(BytesIO(data))
    tags = file.get_section_by_name(".dynamic").iter_tags()
    found = {tag.needed: frozenset[str]() for tag in tags if tag.entry.d_tag == "DT_NEEDED"}
    versions = file.get_section_by_name(".gnu.version_r")
    for library, symbols in versions.iter_versions() if versions else ():
        found[library.name] = frozenset(symbol.name for symbol in symbols)
    return found


def _symbols(file: Any) -> Iterator[tuple[str, bool]]:
    """Yield each symbol that is not local, and whether it is defined."""
    table = file.get_section_by_name(".symtab")
    for symbol in table.iter_symbols() if table else ():
        if symbol["st_info"]["bind"] != "STB_LOCAL":
            yield symbol.name, symbol["st_shndx"] != "SHN_UNDEF"


def _sizes(file: Any) -> tuple[int, int, int]:
    text = data = bss = 0
    for section in file.iter_sections():
        if not section["sh_flags"] & SH_FLAGS.SHF_ALLOC:
            continue
        if section["sh_type"] == "SHT_NOBITS":
            bss += section["sh_size"]
        elif section["sh_flags"] & SH_FLAGS.SHF_WRITE:
            data += section["sh_size"]
        else:
            text += section["sh_size"]
    return text, data, bss
