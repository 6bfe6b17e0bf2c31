# SPDX-License-Identifier: Apache-2.0
"""Where the C library of CycloneDDS is on this machine."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path

from safety_island.errors import ConfigurationError

OPTION = "--ddsc"
VARIABLE = "SAFETY_ISLAND_DDSC"
"""Environment variable: path of the library, or of the folder that holds it."""
_WHEEL = "cyclonedds"
_SEARCH_PATHS = {"LD_LIBRARY_PATH": "", "AMENT_PREFIX_PATH": "lib"}
"""Variables with folders, and where in each the libraries are; a ROS 2 setup file sets both."""


@dataclass(frozen=True)
class Machine:
    """What the search looks at."""

    root: Path = Path("/")
    processor: str = field(default_factory=platform.machine)
    environment: Mapping[str, str] = field(default_factory=lambda: os.environ)
    packages: Path | None = field(default_factory=lambda: _packages_of_wheel())
    """The folder of Python packages that holds the wheel; None where it is not installed."""

    @property
    def triplet(self) -> str:
        """Return Debian's name for the processor and the C library."""
        return f"{self.processor}-linux-gnu"


def find(chosen: Path | None = None, machine: Machine | None = None) -> Path:
    """Return the path of the library: the chosen one, else the variable's, else the first found.

    Raises ConfigurationError when there is none, with what was looked at.
    """
    machine = machine or Machine()
    named = machine.environment.get(VARIABLE)
    if chosen is not None:
        return _named(chosen, OPTION)
    if named:
        return _named(Path(named), VARIABLE)
    folders = list(dict.fromkeys(_folders(machine)))
    for folder in folders:
        if (found := _in_folder(folder)) is not None:
            return found
    raise ConfigurationError(_nowhere(folders, machine))


def _named(path: Path, by: str) -> Path:
    if path.is_file():
        return path
    found = _in_folder(path)
    if found is None:
        raise ConfigurationError(
            f"{by} {path}: expected libddsc.so, the C library of CycloneDDS, or its folder"
        )
    return found


def _in_folder(folder: Path) -> Path | None:
    """Return the library in a folder, whatever follows its name: ``libddsc.so.0``."""
    found = [path for path in folder.glob("libddsc*.so*") if path.is_file()]
    return min(found, key=lambda path: (len(path.name), path.name), default=None)


def _folders(machine: Machine) -> Iterator[Path]:
    """Yield the folders in order: the wheel's, those set for this shell, the system's, ROS 2's."""
    if machine.packages is not None:
        yield machine.packages / f"{_WHEEL}.libs"
    for variable, inside in _SEARCH_PATHS.items():
        listed = machine.environment.get(variable, "")
        yield from (Path(folder, inside) for folder in listed.split(":") if folder)
    yield from _system_folders(machine)
    releases = (machine.root / "opt/ros").glob("*")
    for release in sorted(releases, reverse=True):  # named by the alphabet: the newest first
        yield release / "lib"
        yield release / "lib" / machine.triplet


def _system_folders(machine: Machine) -> Iterator[Path]:
    for folder in ("usr/local/lib", "usr/lib"):
        yield machine.root / folder / machine.triplet
        yield machine.root / folder
    yield machine.root / "usr/lib64"
    for listing in sorted((machine.root / "etc/ld.so.conf.d").glob("*.conf")):
        lines = listing.read_text(errors="replace").splitlines()
        folders = (line.strip() for line in lines)
        yield from (machine.root / line[1:] for line in folders if line.startswith("/"))


def _packages_of_wheel() -> Path | None:
    """Return where the wheel is installed; it is not imported."""
    found = find_spec(_WHEEL)
    return None if found is None or found.origin is None else Path(found.origin).parents[1]


def _nowhere(folders: list[Path], machine: Machine) -> str:
    looked = ", ".join(str(folder) for folder in folders if folder.is_dir())
    return (
        f"libddsc.so, the C library of CycloneDDS, is not on this machine ({machine.processor});"
        f" looked in {looked or 'no folder that exists'}. Install it (pip install cyclonedds, apt"
        f" install cyclonedds-dev, or ROS 2's rmw-cyclonedds-cpp), or name it with {OPTION} PATH or"
        f" {VARIABLE}"
    )
