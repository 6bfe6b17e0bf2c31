# SPDX-License-Identifier: Apache-2.0
"""What a self-contained island carries: the package, what it needs, the results of the build."""

from __future__ import annotations

import json

from safety_island.kernel.library import LIBRARY_NAME, LIBRARY_PLACE
from safety_island.package import PACKAGE
from safety_island.targets.package.built import ABOUT, DOTCONFIG, FOLDER
from safety_island.targets.package.dependencies import files, packages
from safety_island.targets.package.revision import Revision, package_files

_NAME = PACKAGE.name


def content(target: str, revision: Revision, made: dict[str, bytes]) -> dict[str, bytes]:
    """Return the bytes of every file by its place.

    ``made`` holds ``.config`` and the library by the names that they have here.
    """
    found: dict[str, bytes] = {}
    for package in packages():
        found |= {place.as_posix(): source.read_bytes() for place, source in files(package)}
    for path in package_files():
        found[f"{_NAME}/{path.relative_to(PACKAGE).as_posix()}"] = path.read_bytes()
    about = {"target": target, "revision": shown(revision)}
    found |= {
        f"{_NAME}/{FOLDER}/{ABOUT}": (json.dumps(about, sort_keys=True) + "\n").encode(),
        f"{_NAME}/{FOLDER}/{DOTCONFIG}": made[DOTCONFIG],
        f"{_NAME}/{LIBRARY_PLACE}": made[LIBRARY_NAME],
    }
    return found


def shown(revision: Revision) -> str:
    """Return a revision as people read it."""
    if revision.commit is None:
        return "unknown"
    return revision.commit[:12] + ("-modified" if revision.modified else "")
