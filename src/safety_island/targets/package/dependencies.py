# SPDX-License-Identifier: Apache-2.0
"""The installed packages that a built island carries, and which of their files."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path, PurePosixPath

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from safety_island.targets.errors import BuildError

PROJECT = "safety-island"
LEFT_OUT = {
    "numba": "the kernels are compiled already",
    "llvmlite": "the kernels are compiled already",
    "pyelftools": "only the build reads object files",
    "rich-click": "only the command line of cyclonedds uses it",
}
"""Dependencies that a built island does without, and why."""

_SUFFIXES = {".a", ".c", ".cpp", ".f", ".f90", ".h", ".hpp", ".pxd", ".pyc", ".pyi", ".pyx"}
_FOLDERS = {"tests", "_examples", "__pycache__", ".."}
_RECORDS = {"RECORD", "INSTALLER", "REQUESTED", "direct_url.json"}
"""Files of an installation: what they tell holds for another place."""


def packages() -> list[Distribution]:
    """Return every package that the project needs to run, sorted by name.

    Raises BuildError for one that is not installed.
    """
    found: dict[str, Distribution] = {}
    seen: set[tuple[str, frozenset[str]]] = set()
    pending = list(_needs(_installed(PROJECT), set()))
    while pending:
        wanted = pending.pop()
        name = canonicalize_name(wanted.name)
        key = (name, frozenset(wanted.extras))
        if name not in LEFT_OUT and key not in seen:
            seen.add(key)
            found[name] = found.get(name) or _installed(wanted.name)
            pending += _needs(found[name], wanted.extras)
    return [found[name] for name in sorted(found)]


def files(package: Distribution) -> Iterator[tuple[PurePosixPath, Path]]:
    """Yield place and source of each file that is needed to run, in no order."""
    for file in package.files or ():
        if _FOLDERS & set(file.parts) or file.suffix in _SUFFIXES or file.name in _RECORDS:
            continue
        source = Path(str(package.locate_file(file)))
        if source.is_file():
            yield PurePosixPath(file), source


def _installed(name: str) -> Distribution:
    try:
        return distribution(name)
    except PackageNotFoundError:
        raise BuildError(f"the package '{name}' is not installed; run: ./island dev") from None


def _needs(package: Distribution, extras: set[str]) -> Iterator[Requirement]:
    for text in package.requires or ():
        needed = Requirement(text)
        chosen = needed.marker is None or any(
            needed.marker.evaluate({"extra": extra}) for extra in (*extras, "")
        )
        if chosen:
            yield needed
