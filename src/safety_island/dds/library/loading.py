# SPDX-License-Identifier: Apache-2.0
"""The C library, loaded once for the process."""

from __future__ import annotations

import ctypes as ct
from functools import cache, cached_property
from pathlib import Path
from typing import Any

from safety_island.dds.errors import DdsError
from safety_island.dds.library.envelope import Envelope
from safety_island.dds.library.find import find
from safety_island.dds.library.functions import NEWER, PROTOTYPES, SERTYPE
from safety_island.dds.library.release import Release
from safety_island.errors import ConfigurationError


class Library:
    """A loaded library; its functions are attributes, by their C names.

    Raises ConfigurationError for what cannot be loaded or is of no release that is known.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            self.handle = ct.CDLL(str(path))
        except OSError as problem:
            raise ConfigurationError(f"{path} cannot be loaded: {problem}{_hint(path)}") from None
        lacking = [name for name in PROTOTYPES if not hasattr(self.handle, name)]
        if lacking:
            raise ConfigurationError(
                f"{path} is no libddsc of CycloneDDS 0.10 or 11: it lacks {lacking[0]}"
            )

    def __getattr__(self, name: str) -> Any:
        """Return a function of the table, bound when it is first used."""
        prototype = PROTOTYPES.get(name) or NEWER.get(name)
        if prototype is None:
            raise AttributeError(name)
        bound = prototype.bind(self.handle, name)
        setattr(self, name, bound)
        return bound

    @cached_property
    def release(self) -> Release:
        """Which line of releases it is of: it does not say, but one has what the other lacks."""
        return Release.V11 if hasattr(self.handle, SERTYPE) else Release.V0_10

    @cached_property
    def envelope(self) -> Envelope:
        """How this library takes serialized bytes when it tells nothing of a writer's type."""
        return Envelope(self.handle)


def _hint(path: Path) -> str:
    return "; source the setup file of this ROS 2 first" if path.is_relative_to("/opt/ros") else ""


_chosen: Path | None = None


def choose(path: Path) -> None:
    """Use this library, or the one in this folder. Raises DdsError when another one is in use."""
    global _chosen
    if loaded.cache_info().currsize and not loaded().path.samefile(find(path)):
        raise DdsError(f"the library {loaded().path} is in use already, {path} was asked for")
    _chosen = path


@cache
def loaded() -> Library:
    """Return the library of this process, loaded when it is first asked for.

    Raises ConfigurationError when there is none.
    """
    return Library(find(_chosen))
