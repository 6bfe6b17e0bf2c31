# SPDX-License-Identifier: Apache-2.0
"""The sources that machine code of kernels comes from, and their hash.

The cache on disk and the libraries that were compiled ahead of time are both keyed by it, so that
no edit in a kernel, in whatever folder it stands, can run as old machine code.
"""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

from safety_island.package import PACKAGE

ROOMS = (
    "kernel",
    "control",
    "command",
    "life_cycle",
    "guard",
    "core",
    "input_gate",
    "messages",
)
"""Folders of the package that hold kernels, or what they take constants and layouts from."""
_SUFFIXES = {".py", ".idl"}


@cache
def sources_hash() -> str:
    """Return the hash of every kernel source, of its place and of its content; read once."""
    return hash_of(PACKAGE)


def hash_of(package: Path) -> str:
    """Return the hash of the kernel sources of a copy of the package."""
    digest = hashlib.sha256()
    for room in ROOMS:
        for source in sorted((package / room).rglob("*")):
            if source.suffix not in _SUFFIXES:
                continue
            place = source.relative_to(package).as_posix()
            digest.update(place.encode() + b"\0" + source.read_bytes() + b"\0")
    return digest.hexdigest()
