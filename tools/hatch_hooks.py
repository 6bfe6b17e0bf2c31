# SPDX-License-Identifier: Apache-2.0
"""What hatchling asks of this project: metadata, and the kernels inside a platform wheel.

A plain wheel is for any machine and needs the compiler of the kernels. When the environment
variable names a library of compiled kernels (``island build --wheel`` sets it), the wheel carries
the library, is for that machine, and does without the compiler.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from hatchling.metadata.plugin.interface import MetadataHookInterface

LIBRARY = "SAFETY_ISLAND_WHEEL_LIBRARY"
"""Environment variable: path of the library to carry."""
TAG = "SAFETY_ISLAND_WHEEL_TAG"
"""Environment variable: the platform that the library runs on, such as manylinux_2_31_x86_64."""
PLACE = "safety_island/kernel/libsafety_island_control.so"
"""Where the program looks for it (``safety_island.kernel.library``)."""
_PAGES = {"Documentation": "/blob/main/docs", "Changelog": "/blob/main/CHANGELOG.md"}
_RELATIVE = re.compile(r"\]\((?![a-z]+:|#)([^)]+)\)")


class Metadata(MetadataHookInterface):
    """Sets what ``dynamic`` of pyproject.toml lists, from the table of this hook."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Set dependencies, readme and addresses."""
        compiler = metadata["optional-dependencies"]["compile"]
        needed = list(self.config["dependencies"])
        metadata["dependencies"] = needed if os.environ.get(LIBRARY) else [*compiler, *needed]
        repository = self.config["repository"]
        text = Path(self.root, self.config["readme"]).read_text(encoding="utf-8")
        metadata["readme"] = {
            "content-type": "text/markdown",
            "text": _RELATIVE.sub(rf"]({repository}/blob/main/\1)", text),
        }
        metadata["urls"] = {
            "Source": repository,
            "Issues": f"{repository}/issues",
            **{name: f"{repository}{page}" for name, page in _PAGES.items()},
        }


class Kernels(BuildHookInterface):
    """Puts the library into the wheel."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add the library and the tag of its machine."""
        library = os.environ.get(LIBRARY)
        if library and self.target_name == "wheel" and version == "standard":
            build_data["force_include"][library] = PLACE
            build_data["pure_python"] = False
            build_data["tag"] = f"py3-none-{os.environ[TAG]}"
