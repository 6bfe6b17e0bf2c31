# SPDX-License-Identifier: Apache-2.0
"""What a built island knows of its own build: target, revision, configuration."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import NamedTuple

from safety_island.errors import ConfigurationError
from safety_island.package import PACKAGE
from safety_island.targets.kconfig.configuration import RunConfiguration, symbols_of

FOLDER = "built"
"""Beside the rooms, in a built island only."""
ABOUT = "about.json"
DOTCONFIG = ".config"


class Built(NamedTuple):
    """The build that this program comes from."""

    target: str
    revision: str
    dotconfig: Path

    def configuration(self) -> RunConfiguration:
        """Return the configuration that was chosen at build time."""
        text = self.dotconfig.read_text(encoding="utf-8")
        return RunConfiguration.from_symbols(self.target, symbols_of(text, self.dotconfig.name))


@cache
def built() -> Built | None:
    """Return the build of this program, None when it runs from sources."""
    folder = PACKAGE / FOLDER
    try:
        about = json.loads((folder / ABOUT).read_text(encoding="utf-8"))
    except FileNotFoundError:
        return None
    return Built(about["target"], about["revision"], folder / DOTCONFIG)


def refuse_in_built(what: str) -> None:
    """Raise ConfigurationError in a built island, for what only works where it is built."""
    own = built()
    if own is not None:
        raise ConfigurationError(
            f"{what}: this island was built for {own.target} and carries no build tools; use the "
            f"source tree (what it was built with is in {own.dotconfig})"
        )
