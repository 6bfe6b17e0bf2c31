"""The bridge file of the island's own topics, for any pair of domains."""

from __future__ import annotations

from safety_island.dds.topics import BRIDGED, MAIN_COMPUTE_DOMAIN

NAME = "safety_island_bridge"


def render(main_compute: int, safety_island: int) -> str:
    """Return the text of a bridge file like ``demo/bridge/bridge-config.yaml`` for two domains."""
    lines = [f"name: {NAME}", "topics:"]
    for topic in BRIDGED:
        assert topic.bridged is not None
        inward = topic.bridged[0] == MAIN_COMPUTE_DOMAIN
        first, last = (main_compute, safety_island) if inward else (safety_island, main_compute)
        lines += [
            f"  {topic.name}:",
            f"    type: {topic.type_name}",
            f"    from_domain: {first}",
            f"    to_domain: {last}",
        ]
    return "\n".join(lines) + "\n"
