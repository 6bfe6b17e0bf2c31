# SPDX-License-Identifier: Apache-2.0
"""Where the configuration of a target is kept."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from safety_island.package import PACKAGE
from safety_island.targets.kconfig.targets import Target
from safety_island.targets.package.revision import source_tree


def _build_folder() -> Path:
    """``build/`` of the source tree, or of the current folder when there is no source tree."""
    return (source_tree() or Path.cwd()) / "build"


@dataclass(frozen=True)
class Places:
    """``config`` holds Kconfig and the shipped fragments, ``build`` a folder for each target.

    The shipped files are part of the package; ``config/`` of a checkout is a link to them.
    """

    config: Path = PACKAGE / "config"
    build: Path = field(default_factory=_build_folder)

    @property
    def wheels(self) -> Path:
        """Where wheels are made."""
        return self.build.parent / "dist"

    @property
    def kconfig(self) -> Path:
        """The Kconfig file."""
        return self.config / "Kconfig"

    def dotconfig(self, target: Target) -> Path:
        """Where the resolved configuration is written."""
        return self.build / target.name / ".config"

    def saved(self, target: Target) -> Path:
        """The fragment that ``island menuconfig`` writes."""
        return self.build / target.name / "menuconfig.conf"

    def fragments_of(self, target: Target) -> Iterator[Path]:
        """Yield what stands before the user's fragments, in its order."""
        yield self.config / "prj_actuation.conf"
        for name in dict.fromkeys((target.board, target.name)):
            board = self.config / "boards" / f"{name}_actuation.conf"
            if board.exists():
                yield board
        if self.saved(target).exists():
            yield self.saved(target)
