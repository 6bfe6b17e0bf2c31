# SPDX-License-Identifier: Apache-2.0
"""Installs a wheel as a user would, outside the checkout, with the packages that are here."""

from __future__ import annotations

import os
import subprocess
import sys
import tarfile
import venv
import zipfile
from collections.abc import Iterable
from importlib.metadata import distribution
from pathlib import Path

ROOT = Path(__file__).parents[3]
EXTRAS = {"compile": ("numba", "llvmlite"), "osqp": ("osqp", "scipy", "joblib")}


def hatchling(kind: str, source: Path, folder: Path) -> Path:
    """Build a ``wheel`` or an ``sdist`` of a source tree; return its path."""
    command = [sys.executable, "-m", "hatchling", "build", "-t", kind, "-d", str(folder)]
    subprocess.run(command, cwd=source, check=True, capture_output=True)
    (made,) = folder.iterdir()
    return made


def unpacked(sdist: Path, folder: Path) -> Path:
    """Unpack an sdist; return the source tree."""
    with tarfile.open(sdist) as archive:
        archive.extractall(folder, filter="data")
    (root,) = folder.iterdir()
    return root


class Installation:
    """An environment in a folder of its own that holds one wheel."""

    def __init__(self, wheel: Path, folder: Path, extras: Iterable[str]) -> None:
        self.home = folder / "home"
        self.home.mkdir(parents=True)
        venv.create(folder / "venv", symlinks=True, with_pip=False)
        self.python = folder / "venv" / "bin" / "python"
        (self.packages,) = (folder / "venv" / "lib").glob("python*/site-packages")
        _bring_packages(self.packages, {name for extra in extras for name in EXTRAS[extra]})
        with zipfile.ZipFile(wheel) as archive:
            archive.extractall(self.packages)

    def run(self, *arguments: str, timeout: float = 240.0) -> subprocess.CompletedProcess[str]:
        """Run a command of ``island`` in the home folder."""
        kept = {"SAFETY_ISLAND_CACHE", "PATH", "XDG_CACHE_HOME"}
        environment = {key: os.environ[key] for key in kept & os.environ.keys()}
        return subprocess.run(
            [self.python, "-m", "safety_island", *arguments],
            cwd=self.home,
            env=environment | {"HOME": os.environ.get("HOME", "/"), "PYTHONSAFEPATH": "1"},
            capture_output=True,
            text=True,
            timeout=timeout,
        )


def _bring_packages(packages: Path, wanted: set[str]) -> None:
    """Link what is installed here, but the island itself and the extras that are not wanted."""
    optional = {name for names in EXTRAS.values() for name in names} - wanted
    own = {str(file.parts[0]) for file in distribution("safety-island").files or ()}
    for entry in Path(str(distribution("numpy").locate_file(""))).iterdir():
        name = entry.name.partition("-")[0].partition(".")[0]
        if name not in optional and entry.name not in own and name != "__pycache__":
            (packages / entry.name).symlink_to(entry)
