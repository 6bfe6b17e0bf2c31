# SPDX-License-Identifier: Apache-2.0
"""Which sources a build is made from: the revision of git, and a hash of the files themselves."""

from __future__ import annotations

import hashlib
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from safety_island.package import PACKAGE

_IGNORED = "__pycache__"


class Revision(NamedTuple):
    """``commit`` is None outside a git work tree; ``modified``: files differ from it."""

    commit: str | None
    modified: bool


def source_tree() -> Path | None:
    """Return the folder of the checkout (or unpacked sdist) that runs, None when installed."""
    root = PACKAGE.parents[1]
    return root if (root / "pyproject.toml").is_file() and PACKAGE.parent.name == "src" else None


def revision() -> Revision:
    """Return the revision of the source tree; an installed package has none."""
    root = source_tree()
    commit = _git(root, "rev-parse", "HEAD") if root is not None else None
    if root is None or commit is None:
        return Revision(None, False)
    changes = _git(root, "status", "--porcelain", "--", "src", "pyproject.toml")
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


def _git(root: Path, *arguments: str) -> str | None:
    try:
        done = subprocess.run(
            ["git", "-C", str(root), *arguments], capture_output=True, text=True, check=False
        )
    except OSError:
        return None
    return done.stdout if done.returncode == 0 else None
