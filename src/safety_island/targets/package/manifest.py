# SPDX-License-Identifier: Apache-2.0
"""The manifest of a build: what was made of what. It holds no time and no path."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from safety_island.targets.aot.machines import Machine
from safety_island.targets.aot.objects import KernelObject


def kernel_section(objects: Iterable[KernelObject]) -> dict[str, Any]:
    """Return sizes [bytes] and symbols of each object file."""
    return {
        item.name: {
            "size": len(item.data),
            "text": item.elf.text,
            "data": item.elf.data,
            "bss": item.elf.bss,
            "defined": list(item.elf.defined),
            "undefined": list(item.elf.undefined),
        }
        for item in objects
    }


def machine_section(machine: Machine) -> dict[str, str]:
    """Return what a machine is, in LLVM's words."""
    return {"name": machine.name, "triple": machine.triple, "cpu": machine.cpu}


def artefact_section(folder: Path, names: Iterable[str]) -> dict[str, Any]:
    """Return size [bytes] and SHA-256 of files of a build."""
    found = {}
    for name in sorted(names):
        data = (folder / name).read_bytes()
        found[name] = {"size": len(data), "sha256": hashlib.sha256(data).hexdigest()}
    return found


def write_manifest(path: Path, manifest: Mapping[str, Any]) -> None:
    """Write a manifest; the same content gives the same bytes."""
    unfinished = path.with_suffix(".part")
    unfinished.write_text(json.dumps(manifest, indent=2, sort_keys=True) + "\n", encoding="utf-8")
    unfinished.rename(path)


def is_current(path: Path, inputs: Mapping[str, Any]) -> bool:
    """Whether a manifest tells of these inputs, and every file that it lists is as it was made."""
    try:
        manifest = json.loads(path.read_text(encoding="utf-8"))
        listed = manifest["artefacts"]
        if manifest["inputs"] != json.loads(json.dumps(inputs)):
            return False
        return artefact_section(path.parent, listed) == dict(listed)
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return False
