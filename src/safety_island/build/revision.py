"""Which sources a build is made from: the revision of git, and a hash of the files themselves."""

from __future__ import annotations

import hashlib
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

PACKAGE = Path(__file__).parents[1]
PROJECT = PACKAGE.parents[1]
_IGNORED = "__pycache__"


class Revision(NamedTuple):
    """``commit`` is None outside a git work tree; ``modified``: files differ from it."""

    commit: str | None
    modified: bool


def revision() -> Revision:
    """Return the revision of the source tree."""
    commit = _git("rev-parse", "HEAD")
    if commit is None:
        return Revision(None, False)
    changes = _git("status", "--porcelain", "--", "src", "config", "pyproject.toml")
    return Revision(commit.strip(), bool(changes))


def package_files() -> Iterator[Path]:
    """Yield every file of the package, sorted."""
    yield from _files(PACKAGE)


def tree_hash(folder: Path) -> str:
    """Return the hash of names and bytes of all files below a folder."""
    digest = hashlib.sha256()
    for path in _files(folder):
        digest.update(f"{path.relative_to(folder).as_posix()}\0".encode())
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()


def _files(folder: Path) -> Iterator[Path]:
    for path in sorted(folder.rglob("*")):
        if path.is_file() and _IGNORED not in path.parts:
            yield path


def _git(*arguments: str) -> str | None:
    try:
        done = subprocess.run(
            ["git", "-C", str(PROJECT), *arguments], capture_output=True, text=True, check=False
        )
    except OSError:
        return None
    return done.stdout if done.returncode == 0 else None
