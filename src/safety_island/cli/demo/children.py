# SPDX-License-Identifier: Apache-2.0
"""The processes of the demo and their command lines."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from safety_island.cli.demo.child import Child
from safety_island.cli.demo.events import ARM, BRIDGE, ISLAND, PAGE, VEHICLE
from safety_island.dds.topics import BRIDGED, MAIN_COMPUTE_DOMAIN

LOOPBACK = ("--interface", "lo")


def island_child(
    domain: int,
    params: Sequence[str],
    period_s: float | None,
    target: str = "posix",
    tag: str | None = None,
    name: str = ISLAND,
) -> Child:
    """Return the safety island, not started."""
    run = ["run", "--domain", str(domain), "--target", target, "--params", *params]
    if period_s is not None:
        run += ["--period", repr(period_s)]
    return Child(name, [*run, *_tagged(tag), *LOOPBACK, "--json"])


def page_child(domain: int, params: Sequence[str], tag: str | None = None) -> Child:
    """Return the monitor that serves the page, not started."""
    serve = ["monitor", "--domain", str(domain), "--params", *params]
    arguments = [*serve, *_tagged(tag), *LOOPBACK, "--console", "--json"]
    return Child(PAGE, arguments, is_controlled=True)


def bridge_child(domains: tuple[int, int], folder: Path, tag: str | None = None) -> Child:
    """Return the bridge between main compute and island; its file is written to ``folder``."""
    config = folder / "bridge-config.yaml"
    config.write_text(bridge_file(domains), "utf-8")
    tagged = _tagged(tag and f"{domains[1]}={tag}")
    return Child(BRIDGE, ["bridge", str(config), *tagged, *LOOPBACK, "--json"])


def vehicle_child(domain: int, course: str, time_s: float) -> Child:
    """Return the main compute; it drives about ``time_s`` [s], for 0 lap after lap."""
    drive = ["main-compute", "--domain", str(domain), "--course", course]
    drive += ["--within", repr(time_s)] if time_s else ["--repeat"]
    return Child(VEHICLE, [*drive, *LOOPBACK, "--console", "--json"], is_controlled=True)


def arm_child(domain: int, tag: str | None = None) -> Child:
    """Return the request to arm the island, not started."""
    return Child(ARM, ["arm", "--domain", str(domain), *_tagged(tag), *LOOPBACK])


def _tagged(tag: str | None) -> list[str]:
    """Return the option for the tag of the island's domain."""
    return [] if tag is None else ["--domain-tag", tag]


def bridge_file(domains: tuple[int, int]) -> str:
    """Return the bridge file of the island's topics between two domains."""
    main, island = domains
    lines = ["name: demo_bridge", f"from_domain: {main}", f"to_domain: {island}", "topics:"]
    for entry in BRIDGED:
        lines += [f"  {entry.name}:", f"    type: {entry.type_name}"]
        depth = ", depth: 1" if entry.qos.durability == "transient_local" else ""
        qos = f"reliability: {entry.qos.reliability}, durability: {entry.qos.durability}{depth}"
        lines.append(f"    qos: {{{qos}}}")
        if entry.bridged is not None and entry.bridged[0] != MAIN_COMPUTE_DOMAIN:
            lines += ["    reversed: true", "    second_publisher: keep_first"]
    return "\n".join(lines) + "\n"
