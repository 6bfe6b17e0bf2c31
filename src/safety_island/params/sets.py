"""The parameter sets that are shipped with the package."""

from __future__ import annotations

from functools import cache
from importlib.resources import files

from safety_island.errors import ConfigurationError
from safety_island.params.convert import nearest
from safety_island.params.source import Source
from safety_island.params.tree import parse

SETS = ("firmware", "autoware-0.40", "default")
"""Names of the shipped sets."""

FILES = (
    "vehicle_info.param.yaml",
    "trajectory_follower_node.param.yaml",
    "nearest_search.param.yaml",
    "lateral/mpc.param.yaml",
    "longitudinal/pid.param.yaml",
)
"""Files of a set, below its folder."""


@cache
def sources_of(name: str) -> tuple[Source, ...]:
    """Return the files of a shipped set; raise ConfigurationError when there is none."""
    if name not in SETS:
        near = nearest(name, SETS)
        hint = f"; the nearest is {near}" if near else ""
        raise ConfigurationError(
            f"parameter set {name!r} is not shipped; expected one of {', '.join(SETS)}{hint}"
        )
    folder = files(__package__) / "sets" / name
    return tuple(
        Source(f"{name}/{file}", folder.joinpath(*file.split("/")).read_text("utf-8"))
        for file in FILES
    )


@cache
def file_of_key() -> dict[str, str]:
    """Return YAML key -> the file of FILES that holds it in every shipped set."""
    sources = zip(FILES, sources_of("default"), strict=True)
    return {entry.key: file for file, source in sources for entry in parse(source).entries}
