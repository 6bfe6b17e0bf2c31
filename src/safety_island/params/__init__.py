# SPDX-License-Identifier: Apache-2.0
"""Parameter sets: Autoware's own YAML files, checked, over the sets that are shipped."""

from safety_island.params.describe import Row, describe
from safety_island.params.fingerprint import parameters_hash
from safety_island.params.layers import Ignored
from safety_island.params.loader import (
    Loaded,
    check,
    from_mapping,
    load,
    load_set,
    notes,
    read,
    replace,
    with_period,
)
from safety_island.params.problem import ParameterError, Place, Problem
from safety_island.params.schema import IslandParameters
from safety_island.params.sets import SETS

__all__ = [
    "SETS",
    "Ignored",
    "IslandParameters",
    "Loaded",
    "ParameterError",
    "Place",
    "Problem",
    "Row",
    "check",
    "describe",
    "from_mapping",
    "load",
    "load_set",
    "notes",
    "parameters_hash",
    "read",
    "replace",
    "with_period",
]
