# SPDX-License-Identifier: Apache-2.0
"""All that the bytes of a build depend on."""

from __future__ import annotations

import hashlib
import platform
from importlib.metadata import version
from typing import Any

from safety_island import __version__
from safety_island.kernel.sources import sources_hash
from safety_island.package import PACKAGE
from safety_island.targets.aot.linker import find_compiler
from safety_island.targets.kconfig.resolve import Resolved
from safety_island.targets.package.dependencies import packages
from safety_island.targets.package.products import Product
from safety_island.targets.package.revision import Revision, tree_hash

_COMPILERS = ("llvmlite", "numba", "numpy")


def inputs(resolved: Resolved, product: Product, git: Revision) -> dict[str, Any]:
    """Return the inputs of a build, ready for JSON."""
    compiler = find_compiler()
    carried = packages()
    return {
        "target": resolved.target.name,
        "program": product.name,
        "version": __version__,
        "revision": {"commit": git.commit, "modified": git.modified},
        "configuration": hashlib.sha256(resolved.dotconfig().encode()).hexdigest(),
        "sources": tree_hash(PACKAGE),
        "kernel_sources": sources_hash(),
        "python": platform.python_version(),
        "c_compiler": None if compiler is None else compiler.name,
        "compilers": {name: version(name) for name in _COMPILERS},
        "packages": {package.metadata["Name"]: package.version for package in carried},
    }
