# SPDX-License-Identifier: Apache-2.0
"""The build of one target, step by step, into ``build/<target>/``."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from safety_island.extras import require
from safety_island.kernel.library import LIBRARY_NAME
from safety_island.messages import registry
from safety_island.targets.aot.archive import archive
from safety_island.targets.aot.linker import check_header, link_shared, needed_compiler
from safety_island.targets.aot.machines import Machine, machine_of
from safety_island.targets.aot.objects import KernelObject, kernel_objects
from safety_island.targets.errors import BuildError
from safety_island.targets.headers.control import NAME as CONTROL_HEADER
from safety_island.targets.headers.control import control_header, record_names, record_sizes
from safety_island.targets.headers.messages import NAME as MESSAGE_HEADER
from safety_island.targets.headers.messages import message_header
from safety_island.targets.kconfig.places import Places
from safety_island.targets.kconfig.resolve import Resolved
from safety_island.targets.package.built import DOTCONFIG
from safety_island.targets.package.content import content
from safety_island.targets.package.inputs import inputs
from safety_island.targets.package.manifest import (
    artefact_section,
    is_current,
    kernel_section,
    machine_section,
    write_manifest,
)
from safety_island.targets.package.products import APPLICATION, Product
from safety_island.targets.package.pyz import write_pyz
from safety_island.targets.package.revision import revision

Say = Callable[[str], None]
"""Told each step, in words."""

ARCHIVE_NAME = "libsafety_island_control.a"


class Build:
    """One build. ``run`` raises BuildError when it cannot be finished."""

    def __init__(self, resolved: Resolved, product: Product, places: Places, say: Say) -> None:
        require("compile", "island build")
        self.target = resolved.target
        self.machine: Machine = machine_of(resolved.target)
        self.folder = places.dotconfig(resolved.target).parent
        self.manifest_path = self.folder / product.manifest
        self._resolved = resolved
        self._product = product
        self._say = say
        self._git = revision()
        self._inputs = inputs(resolved, product, self._git)
        self._made: dict[str, bytes] = {}
        self.files: list[str] = []
        """What was made, by its name in the folder."""
        self._tools: dict[str, str | None] = {}
        if not self.machine.is_host and product is not APPLICATION:
            raise BuildError(
                f"--{product.name}: {self.target.name} ({self.machine.name}) runs no Python; "
                "build the test programs for posix or freertos_posix"
            )

    def is_current(self) -> bool:
        """Whether everything is there and nothing has changed since it was made."""
        return is_current(self.manifest_path, self._inputs)

    def run(self) -> None:
        """Make everything; the manifest is written last."""
        if self.machine.is_host:
            needed_compiler()  # told now, not after a minute
        self.manifest_path.unlink(missing_ok=True)
        self._configuration()
        self._messages()
        objects = self._kernels()
        self._header()
        if self.machine.is_host:
            self._library(objects)
            self._program()
        else:
            self._archive(objects)
        self._manifest(objects)

    def _configuration(self) -> None:
        self._say("configuration")
        self._write(DOTCONFIG, self._resolved.dotconfig().encode())

    def _messages(self) -> None:
        self._say(f"message types: {len(registry.names())} from IDL")
        self._write(MESSAGE_HEADER, message_header().encode(), f"include/{MESSAGE_HEADER}")

    def _kernels(self) -> list[KernelObject]:
        self._say(f"control kernels for {self.machine.name}")
        objects = kernel_objects(
            self.machine, lambda name, i, n: self._say(f"  kernel {i + 1} of {n}: {name}")
        )
        for item in objects:
            self._write(f"{item.name}.o", item.data, f"objects/{item.name}.o")
        return objects

    def _header(self) -> None:
        from safety_island.targets.headers.layout import check_layout

        self._say("C headers")
        self._write(CONTROL_HEADER, control_header().encode(), f"include/{CONTROL_HEADER}")
        check_layout(record_names(), self.machine)
        for name in (CONTROL_HEADER, MESSAGE_HEADER):
            self._tools["headers_read_by"] = check_header(self.folder / "include" / name)

    def _library(self, objects: list[KernelObject]) -> None:
        self._say(f"shared library {LIBRARY_NAME}")
        files = [self.folder / "objects" / f"{item.name}.o" for item in objects]
        self._tools["linker"] = link_shared(files, self.folder / LIBRARY_NAME, self.machine)
        self._made[LIBRARY_NAME] = (self.folder / LIBRARY_NAME).read_bytes()
        self.files.append(LIBRARY_NAME)

    def _archive(self, objects: list[KernelObject]) -> None:
        self._say(f"static library {ARCHIVE_NAME}")
        members = {f"{item.name}.o": item.data for item in objects}
        symbols = {f"{item.name}.o": item.elf.defined for item in objects}
        self._write(ARCHIVE_NAME, archive(members, symbols))

    def _program(self) -> None:
        name = f"{self._product.file}.pyz"
        self._say(f"self-contained program {name}")
        carried = content(self.target.name, self._git, self._made)
        write_pyz(self.folder / name, carried, self._product.entry)
        self.files.append(name)

    def _manifest(self, objects: list[KernelObject]) -> None:
        undefined = {symbol for item in objects for symbol in item.elf.undefined}
        manifest: dict[str, Any] = {
            "inputs": self._inputs,
            "machine": machine_section(self.machine),
            "kernels": kernel_section(objects),
            "records": record_sizes(),
            "undefined_symbols": sorted(undefined),
            "tools": self._tools,
            "artefacts": artefact_section(self.folder, self.files),
        }
        write_manifest(self.manifest_path, manifest)

    def _write(self, key: str, data: bytes, place: str | None = None) -> None:
        path = self.folder / (place or key)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
        self._made[key] = data
        self.files.append(place or key)
