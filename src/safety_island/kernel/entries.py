# SPDX-License-Identifier: Apache-2.0
"""Which modules define the entries: whoever compiles or counts them all has them imported here."""

from __future__ import annotations

from importlib import import_module

from safety_island.kernel import kernel

MODULES = (
    "safety_island.control.follower",
    "safety_island.control.qp_alone",
    "safety_island.core.guard",
    "safety_island.command.can_frames",
    "safety_island.command.control_message",
    "safety_island.command.status_message",
    "safety_island.life_cycle.tick",
    "safety_island.life_cycle.island_watch",
    "safety_island.input_gate.clock.judge",
    "safety_island.input_gate.clock.sender",
    "safety_island.input_gate.decode.inputs",
)


def all_entries(on_demand: bool = False) -> list[kernel.Entry]:
    """Return every entry of the island, in the order of definition; ``on_demand``: those too."""
    for name in MODULES:
        import_module(name)
    return kernel.ENTRIES + (kernel.ON_DEMAND if on_demand else [])
