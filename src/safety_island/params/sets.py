# SPDX-License-Identifier: Apache-2.0
"""The parameter sets that are shipped with the package."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from importlib.resources.abc import Traversable

from safety_island.errors import ConfigurationError
from safety_island.params.convert import nearest
from safety_island.params.source import Source
from safety_island.params.tree import parse

SETS = ("firmware", "autoware-0.40", "autoware-0.50", "autoware-0.53", "default")
"""Names of the shipped sets."""

OWN = ("gate.param.yaml", "life_cycle.param.yaml", "guard.param.yaml")
"""Files that are the island's own: the same under every set, in the folder ``island``."""

FILES = (
    "vehicle_info.param.yaml",
    "trajectory_follower_node.param.yaml",
    "nearest_search.param.yaml",
    "lateral/mpc.param.yaml",
    "longitudinal/pid.param.yaml",
    *OWN,
)
"""Files of a set, below its folder; those of OWN are shared by all."""

EXCEPTIONS = "island.param.yaml"
"""File of a set, where it has one, that changes values of the island's own files."""


@cache
def sources_of(name: str) -> tuple[Source, ...]:
    """Return the files of a shipped set; raise ConfigurationError when there is none."""
    if name not in SETS:
        near = nearest(name, SETS)
        hint = f"; the nearest is {near}" if near else ""
        raise ConfigurationError(
            f"parameter set {name!r} is not shipped; expected one of {', '.join(SETS)}{hint}"
        )
    found = [_source("island" if file in OWN else name, file) for file in FILES]
    if _place(name, EXCEPTIONS).is_file():
        found.append(_source(name, EXCEPTIONS))
    return tuple(found)


def _place(folder: str, file: str) -> Traversable:
    return (files(__package__) / "sets").joinpath(folder, *file.split("/"))


def _source(folder: str, file: str) -> Source:
    return Source(f"{folder}/{file}", _place(folder, file).read_text("utf-8"))


@cache
def file_of_key() -> dict[str, str]:
    """Return YAML key -> the file of FILES that holds it in every shipped set."""
    sources = zip(FILES, sources_of("default"), strict=True)  # the default has no exceptions
    return {entry.key: file for file, source in sources for entry in parse(source).entries}
