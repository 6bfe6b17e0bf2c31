"""The three processes of the demo and their command lines."""

from __future__ import annotations

import argparse
from pathlib import Path

from safety_island.cli.demo.child import Child
from safety_island.cli.demo.events import BRIDGE, ISLAND, VEHICLE
from safety_island.dds.topics import BRIDGED, MAIN_COMPUTE_DOMAIN

LOOPBACK = ("--interface", "lo")


def make_children(
    arguments: argparse.Namespace, domains: tuple[int, int], folder: Path
) -> list[Child]:
    """Return the processes, not started; the bridge's file is written to ``folder``.

    ``domains``: of the main compute, of the island.
    """
    main, island = (str(domain) for domain in domains)
    config = folder / "bridge-config.yaml"
    config.write_text(bridge_file(domains), "utf-8")
    run = ["run", "--domain", island, "--params", *arguments.params, *LOOPBACK, "--json"]
    run += ["--target", arguments.target]
    if arguments.period is not None:
        run += ["--period", repr(arguments.period)]
    drive = ["main-compute", "--domain", main, "--course", arguments.course, *LOOPBACK, "--json"]
    drive += ["--within", repr(arguments.duration)] if arguments.duration else ["--repeat"]
    return [
        Child(ISLAND, run),
        Child(BRIDGE, ["bridge", str(config), *LOOPBACK, "--json"]),
        Child(VEHICLE, drive),
    ]


def bridge_file(domains: tuple[int, int]) -> str:
    """Return the bridge file of the island's topics between two domains."""
    main, island = domains
    lines = ["name: demo_bridge", f"from_domain: {main}", f"to_domain: {island}", "topics:"]
    for entry in BRIDGED:
        lines += [f"  {entry.name}:", f"    type: {entry.type_name}"]
        if entry.bridged is not None and entry.bridged[0] != MAIN_COMPUTE_DOMAIN:
            lines.append("    reversed: true")
    return "\n".join(lines) + "\n"
