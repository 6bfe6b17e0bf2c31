# SPDX-License-Identifier: Apache-2.0
"""The start of a self-contained island: unpacks what it carries, once, and runs it from there.

Runs before anything else is there, so it uses the standard library alone, and of the island the
rule which folders can be trusted (``private_folder.py``, carried beside this file).
"""

from __future__ import annotations

import importlib
import os
import platform
import shutil
import signal
import sys
import tempfile
import zipfile
from pathlib import Path
from typing import NoReturn, Protocol

CONTENT = "content/"
"""Folder of the archive that is unpacked."""
COMPLETE = ".complete"
"""Written last: a folder without it is not used."""


class Trust(Protocol):
    """The module ``private_folder``."""

    def make_private(self, folder: Path) -> None:
        """Make a folder for this user alone."""

    def distrust(self, folder: Path) -> str:
        """Say why another user could have changed what is in a folder."""


def start(digest: str, python: str, machine: str, program: str, trust: Trust) -> NoReturn:
    """Run ``program`` (``module:function``) out of the archive that this process runs.

    ``digest`` names the content, ``python`` (``3.11``) and ``machine`` what it was built for.
    """
    archive = Path(sys.argv[0]).absolute()
    _check(archive, python, machine)
    try:
        folder = unpacked(archive, digest, trust)
    except (OSError, zipfile.BadZipFile) as error:
        _fail(f"{archive} cannot be unpacked: {error}; name another place by SAFETY_ISLAND_CACHE")
    except KeyboardInterrupt:
        sys.exit(128 + signal.SIGINT)
    sys.path[0] = str(folder)
    # What this process starts must find the same files.
    others = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = f"{folder}{os.pathsep}{others}" if others else str(folder)
    module, _, function = program.partition(":")
    sys.exit(getattr(importlib.import_module(module), function)())


def unpacked(archive: Path, digest: str, trust: Trust) -> Path:
    """Return the folder with the content, which is unpacked when it is not there yet."""
    folder = cache_folder() / f"island-{digest[:16]}"
    trust.make_private(folder.parent)
    if why := trust.distrust(folder if os.path.lexists(folder) else folder.parent):
        _fail(f"{why}; name a folder of your own by SAFETY_ISLAND_CACHE")
    if (folder / COMPLETE).exists():
        return folder
    print(f"island: unpacking {archive.name} to {folder}, once", file=sys.stderr, flush=True)
    unfinished = Path(tempfile.mkdtemp(prefix=f"{folder.name}-", dir=folder.parent))
    try:
        _extract(archive, unfinished)
        _install(unfinished, folder)
    finally:
        shutil.rmtree(unfinished, ignore_errors=True)
    return folder


def cache_folder() -> Path:
    """Return the folder that holds unpacked content."""
    chosen = os.environ.get("SAFETY_ISLAND_CACHE")
    if chosen:
        return Path(chosen)
    home = os.environ.get("XDG_CACHE_HOME")
    return (Path(home) if home else Path("~/.cache").expanduser()) / "safety-island"


def _extract(archive: Path, folder: Path) -> None:
    with zipfile.ZipFile(archive) as source:
        for name in source.namelist():
            if name.startswith(CONTENT):
                target = folder / name[len(CONTENT) :]
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_bytes(source.read(name))
    (folder / COMPLETE).touch()
    os.sync()  # a power failure must not leave a folder that only looks complete


def _install(unfinished: Path, folder: Path) -> None:
    """Give the folder its name; another process may have been quicker."""
    if folder.exists() and not (folder / COMPLETE).exists():
        shutil.rmtree(folder)
    try:
        unfinished.rename(folder)
    except OSError:
        if not (folder / COMPLETE).exists():
            raise


def _check(archive: Path, python: str, machine: str) -> None:
    found = f"{sys.version_info.major}.{sys.version_info.minor}"
    if (found, sys.implementation.name) != (python, "cpython"):
        kind = f"{sys.implementation.name} {found}"
        _fail(f"{archive.name} was built for Python {python}, this is {kind}: run python{python}")
    if platform.machine() != machine:
        _fail(f"{archive.name} was built for {machine}, this machine is {platform.machine()}")


def _fail(message: str) -> NoReturn:
    print(f"island: error: {message}", file=sys.stderr)
    sys.exit(2)
