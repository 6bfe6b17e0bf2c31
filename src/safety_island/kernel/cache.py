# SPDX-License-Identifier: Apache-2.0
"""Where compiled kernels are kept: a folder named after the content that they come from.

Numba's own rule (path and time of one source file) would not notice an edit in a function that was
imported from another file, and would compile again for every copy of the same sources. Here the
key is a hash of all kernel sources, so any copy of them finds the code, and no other one does.

Numba's files are pickles, so a folder that another user could have changed is not used.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numba
import numpy as np
from numba.core.caching import _CacheLocator

from safety_island.errors import ConfigurationError
from safety_island.kernel.sources import sources_hash
from safety_island.private_folder import distrust, make_private

LOCATOR = f"{__name__}.Locator"
"""For Numba's setting ``CACHE_LOCATOR_CLASSES``."""


class Place(NamedTuple):
    """Where compiled code is kept: the folder, None when there is no place for it."""

    folder: Path | None
    note: str
    """What was found, where that is not the folder that was asked for; empty: it is."""


@cache
def code_hash() -> str:
    """Hash of all that compiled code depends on: kernel sources, versions of Numba and NumPy."""
    made_of = f"{numba.__version__} {np.__version__} {sources_hash()}"
    return hashlib.sha256(made_of.encode()).hexdigest()[:16]


@cache
def place() -> Place:
    """Return the first folder that can be used, made: below $SAFETY_ISLAND_CACHE or ~/.cache.

    Where that one cannot be used, one below $XDG_RUNTIME_DIR, which is this user's alone.
    """
    reasons: list[str] = []
    for root in _roots():
        folder = root / f"kernels-{code_hash()}"
        try:
            make_private(folder)
            why = distrust(folder)
        except OSError as error:
            why = f"{folder} cannot be made: {error.strerror}"
        if not why and not os.access(folder, os.W_OK) and not any(folder.glob("*.nbi")):
            why = f"{folder} cannot be written"
        if not why:
            return Place(folder, _note(reasons, f"compiled code is kept in {folder}"))
        reasons.append(why)
    return Place(None, _note(reasons, "compiled code is not kept, so each start compiles it"))


def cache_folder() -> Path:
    """Return the folder. Raises ConfigurationError when there is none."""
    folder, note = place()
    if folder is None:
        raise ConfigurationError(note)
    return folder


def _roots() -> list[Path]:
    home = os.environ.get("XDG_CACHE_HOME")
    default = (Path(home) if home else Path("~/.cache").expanduser()) / "safety-island"
    roots = [Path(os.environ.get("SAFETY_ISLAND_CACHE") or default)]
    if runtime := os.environ.get("XDG_RUNTIME_DIR"):
        roots.append(Path(runtime) / "safety-island")
    return roots


def _note(reasons: list[str], done: str) -> str:
    advice = "set SAFETY_ISLAND_CACHE to a folder of your own"
    return f"{'; '.join(reasons)}: {done} ({advice})" if reasons else ""


@contextmanager
def lock(name: str) -> Iterator[bool]:
    """Let one process at a time compile an entry; yields False, at once, when another one does."""
    folder = place().folder
    descriptor = _open_lock(folder / f"{name}.lock") if folder is not None else None
    if descriptor is None:
        yield False
        return
    try:
        yield _is_locked(descriptor)
    finally:
        os.close(descriptor)


def _open_lock(path: Path) -> int | None:
    try:
        return os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o600)
    except OSError:  # such as a folder that can only be read
        return None


def _is_locked(descriptor: int) -> bool:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


def lock_holder(name: str) -> int | None:
    """Return the process that holds the lock of an entry; None: none, or the kernel hides it."""
    path = cache_folder() / f"{name}.lock"
    try:
        inode = str(path.stat().st_ino)
        rows = [line.split() for line in Path("/proc/locks").read_text("ascii").splitlines()]
    except OSError:
        return None
    # 7: FLOCK ADVISORY WRITE 4242 08:01:131090 0 EOF; one that waits has "->" after its number
    held = [row for row in rows if row[1] == "FLOCK" and row[5].rpartition(":")[2] == inode]
    return int(held[0][4]) if held else None


class Locator(_CacheLocator):
    """Tells Numba the folder; the hash in its name says all there is to say of freshness."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self._line = function.__code__.co_firstlineno

    def get_cache_path(self) -> str:
        """The folder."""
        return str(cache_folder())

    def get_source_stamp(self) -> str:
        """The hash."""
        return code_hash()

    def get_disambiguator(self) -> str:
        """Tells functions of one name apart."""
        return str(self._line)

    @classmethod
    def from_function(cls, py_func: Callable[..., Any], py_file: str) -> Locator:
        """Numba's way to make one."""
        return cls(py_func)
