# SPDX-License-Identifier: Apache-2.0
"""Writes a self-contained island: one file that Python runs without anything installed."""

from __future__ import annotations

import hashlib
import io
import platform
import sys
import zipfile
from collections.abc import Mapping
from pathlib import Path

from safety_island import private_folder
from safety_island.targets.package import pyz_start

_SHEBANG = b"#!/usr/bin/env python3\n"
_DATE = (1980, 1, 1, 0, 0, 0)  # the same inputs give the same bytes
_MODE = 0o644 << 16
_MAIN = """\
import private_folder
from pyz_start import start

start(
    digest="{digest}",
    python="{python}",
    machine="{machine}",
    program="{program}",
    trust=private_folder,
)
"""


def digest_of(content: Mapping[str, bytes]) -> str:
    """Return the hash of names and bytes."""
    digest = hashlib.sha256()
    for name in sorted(content):
        digest.update(f"{name}\0{len(content[name])}\0".encode() + content[name])
    return digest.hexdigest()


def write_pyz(path: Path, content: Mapping[str, bytes], program: str) -> None:
    """Write an archive that unpacks ``content`` (bytes by place) and runs ``module:function``."""
    main = _MAIN.format(
        digest=digest_of(content),
        python=f"{sys.version_info.major}.{sys.version_info.minor}",
        machine=platform.machine(),
        program=program,
    )
    members = {"__main__.py": main.encode()}
    for module in (pyz_start, private_folder):
        place = Path(str(module.__file__))
        members[place.name] = place.read_bytes()
    members |= {f"{pyz_start.CONTENT}{name}": content[name] for name in sorted(content)}
    memory = io.BytesIO()
    memory.write(_SHEBANG)
    with zipfile.ZipFile(memory, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in members.items():
            item = zipfile.ZipInfo(name, _DATE)
            item.external_attr, item.compress_type = _MODE, zipfile.ZIP_DEFLATED
            archive.writestr(item, data)
    unfinished = path.with_suffix(".part")
    unfinished.write_bytes(memory.getvalue())
    unfinished.chmod(0o755)
    unfinished.rename(path)
