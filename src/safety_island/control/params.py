# SPDX-License-Identifier: Apache-2.0
"""Every parameter of the controllers and the node: name, type, unit, range.

The names are Autoware's own, a dot in a key written as an underscore. There are no defaults here:
values live in the parameter sets (``safety_island.params``), each with its source.
"""

from __future__ import annotations

from dataclasses import dataclass

from safety_island.control.lateral_params import LateralParams
from safety_island.control.longitudinal_params import LongitudinalParams
from safety_island.control.vehicle_params import NodeParams, VehicleParams
from safety_island.parameter import key_of, parameter

__all__ = [
    "LateralParams",
    "LongitudinalParams",
    "NodeParams",
    "Parameters",
    "VehicleParams",
    "key_of",
    "parameter",
]


@dataclass(frozen=True)
class Parameters:
    """One complete set."""

    vehicle: VehicleParams
    node: NodeParams
    lateral: LateralParams
    longitudinal: LongitudinalParams
