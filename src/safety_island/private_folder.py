# SPDX-License-Identifier: Apache-2.0
"""Folders that nobody but their owner can change: what lies in one may be run.

Compiled code is unpickled and unpacked programs are imported, so whoever can write there runs code
as this user. Uses the standard library alone: self-contained programs carry a copy of this file.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator
from pathlib import Path

_OVERFLOW_UID = 65534
"""How a user namespace shows every user that it does not know, root among them."""


def make_private(folder: Path) -> None:
    """Make a folder, and those that are missing above it, for this user alone. Raises OSError."""
    missing = [above for above in (*reversed(folder.parents), folder) if not above.exists()]
    for path in missing:
        path.mkdir(mode=0o700, exist_ok=True)


def distrust(folder: Path) -> str:
    """Say why another user could have changed the content of a folder; empty: none could.

    Looks at the folder, at what it holds (not further down) and at every folder above it.
    Raises OSError when one of them cannot be looked at.
    """
    found = folder.lstat()
    if not stat.S_ISDIR(found.st_mode):
        return f"{folder} is not a folder but {_kind(found)}"
    if why := _foreign(folder, found) or _is_open(folder, found, 0o022):
        return why
    for above in _above(folder):
        if why := _distrust_above(above):
            return why
    with os.scandir(folder) as entries:
        return next(filter(None, map(_distrust_entry, entries)), "")


def _above(folder: Path) -> Iterator[Path]:
    """Yield each folder that the path leads through, links and what they point to included."""
    yield from folder.absolute().parents
    yield from folder.resolve().parents


def _distrust_above(path: Path) -> str:
    found = path.lstat()
    if found.st_uid != _OVERFLOW_UID and (why := _foreign(path, found)):
        return why
    if stat.S_ISLNK(found.st_mode) or found.st_mode & stat.S_ISVTX:
        return ""  # with the sticky bit others may add, and not replace
    own_group = found.st_gid in (0, os.getegid())
    return _is_open(path, found, 0o002 if own_group else 0o022)


def _distrust_entry(entry: os.DirEntry[str]) -> str:
    found = entry.stat(follow_symlinks=False)
    if not stat.S_ISREG(found.st_mode) and not stat.S_ISDIR(found.st_mode):
        return f"{entry.path} is {_kind(found)}"
    return _foreign(Path(entry.path), found)


def _foreign(path: Path, found: os.stat_result) -> str:
    own = os.geteuid()
    if found.st_uid in (own, 0):
        return ""
    return f"{path} belongs to user {found.st_uid}, not to {own}"


def _is_open(path: Path, found: os.stat_result, mask: int) -> str:
    mode = stat.S_IMODE(found.st_mode)
    return f"{path} can be written by others (mode {mode:o})" if mode & mask else ""


def _kind(found: os.stat_result) -> str:
    kinds = {stat.S_IFLNK: "a link", stat.S_IFREG: "a file"}
    return kinds.get(stat.S_IFMT(found.st_mode), "something else")
