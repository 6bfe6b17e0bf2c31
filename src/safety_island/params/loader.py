# SPDX-License-Identifier: Apache-2.0
"""Parameters from Autoware's YAML files, over one of the shipped sets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from safety_island.params import consistency
from safety_island.params.layers import Ignored, Layers
from safety_island.params.problem import ParameterError, Place, Problem
from safety_island.params.releases import RELEASE
from safety_island.params.schema import IslandParameters, assemble, values_of
from safety_island.params.sets import sources_of

DEFAULT = "default"
"""The set under the user's files when none is named."""


@dataclass(frozen=True)
class Loaded:
    """A complete set, where each of its values comes from, and what a reader should know of it.

    ``ignored`` are the keys without effect, ``translated`` a line for each older key.
    """

    parameters: IslandParameters
    origins: Mapping[str, Place]
    ignored: tuple[Ignored, ...]
    translated: tuple[str, ...] = ()

    @property
    def release(self) -> str:
        """Which release's rules the controllers follow, and why, as one line."""
        release = self.parameters.node.autoware_release
        return f"rules of Autoware {release} ({self.origins[RELEASE]})"


def read(
    files: Sequence[Path] = (),
    base: str | None = DEFAULT,
    overrides: Mapping[str, object] | None = None,
    *,
    name: str = "override",
) -> Loaded:
    """Read a shipped set, files over it in their order, and single values over those.

    ``base`` None takes nothing that the files do not give. A text among the overrides is read as in
    a file ("0.24", "true", "[1, 2]"); ``name`` is how errors call them. Raises ParameterError with
    every problem of every file.
    """
    layers = Layers()
    for source in sources_of(base) if base is not None else ():
        layers.add_source(source)
    for path in files:
        layers.add_file(Path(path))
    if overrides:
        layers.add_mapping(overrides, name)
    layers.decide_release()
    layers.check()
    if layers.problems:
        raise ParameterError(layers.problems)
    origins = {key: entry.place for key, entry in layers.origins.items()}
    return Loaded(assemble(layers.values), origins, tuple(layers.ignored), tuple(layers.translated))


def load(
    files: Sequence[Path],
    base: str | None = DEFAULT,
    overrides: Mapping[str, object] | None = None,
) -> IslandParameters:
    """Return the parameters that ``read`` reads."""
    return read(files, base, overrides).parameters


def check(files: Sequence[Path], base: str | None = DEFAULT) -> tuple[Problem, ...]:
    """Return what is wrong with files over a shipped set; nothing when they can be used."""
    try:
        read(files, base)
    except ParameterError as error:
        return error.problems
    return ()


def load_set(name: str) -> IslandParameters:
    """Return a shipped set, one of SETS."""
    return read((), name).parameters


def from_mapping(overrides: Mapping[str, object], base: str = DEFAULT) -> IslandParameters:
    """Return a shipped set with some values replaced, by the keys of the files."""
    return read((), base, overrides).parameters


def replace(parameters: IslandParameters, values: Mapping[str, Any], name: str) -> IslandParameters:
    """Return the parameters with some values replaced and everything checked again.

    ``name`` is how errors call the source of the values. Raises ParameterError.
    """
    layers = Layers()
    layers.add_mapping(values_of(parameters), "parameters")
    layers.add_mapping(values, name)
    layers.check()
    if layers.problems:
        raise ParameterError(layers.problems)
    return assemble(layers.values)


def with_period(parameters: IslandParameters, period: float) -> IslandParameters:
    """Return the parameters at another control period [s], checked again.

    Raises ParameterError, for example when a filter's cutoff is too high for it.
    """
    return replace(parameters, {"ctrl_period": period}, "--period")


def notes(parameters: IslandParameters) -> list[str]:
    """Return what a start should say once about these parameters, one line each."""
    return consistency.notes(values_of(parameters))
