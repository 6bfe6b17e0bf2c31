# SPDX-License-Identifier: Apache-2.0
"""``island env``: what another DDS program needs in its environment to meet the island."""

from __future__ import annotations

import argparse
import shlex
from collections.abc import Mapping

from safety_island.cli import options
from safety_island.cli.parser import teach
from safety_island.errors import ConfigurationError


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    teach(
        parser,
        """
Print what another program needs to meet an island that runs with the same options, as lines for a
shell. A program with CycloneDDS that chooses a network interface by itself does not look on
loopback, where the island is by default; one with Fast DDS does.
""",
        ("island env", "variables for ros2 and the island on domain 2"),
        ('eval "$(island env --for cyclonedds)"', "set those of a CycloneDDS program, here"),
        ("island env --interface eth0 --peer 192.168.7.2", "on a network without multicast"),
    )
    parser.add_argument(
        "--for",
        dest="whom",
        choices=("ros2", "cyclonedds", "fastdds"),
        default="ros2",
        help="ros2: any ROS 2 node, whatever its middleware; cyclonedds, fastdds: other programs "
        "with that library (default: ros2)",
    )
    options.add_domain(parser, 2, "the safety island")
    options.add_interface(parser)
    options.add_peers_and_tag(parser)


def execute(arguments: argparse.Namespace) -> int:
    """Print the variables."""
    for name, value in variables(arguments).items():
        print(f"export {name}={shlex.quote(value)}")
    return 0


def variables(arguments: argparse.Namespace) -> Mapping[str, str]:
    """Return the environment variables that the other program needs.

    Raises ConfigurationError for what it cannot do.
    """
    from safety_island.dds.config import URI, DdsConfig

    config = DdsConfig(interface=arguments.interface, **options.peers_and_tags(arguments))
    xml = config.peer_xml(arguments.domain)
    if arguments.whom == "cyclonedds":
        return {URI: xml}
    found = {"ROS_DOMAIN_ID": str(arguments.domain)}
    if config.peers:
        found["ROS_STATIC_PEERS"] = ";".join(config.peers)
    tagged = bool(config.tag(arguments.domain))
    if arguments.whom == "fastdds":
        if tagged:
            raise ConfigurationError("--domain-tag: Fast DDS has none; expected CycloneDDS there")
        return found
    if tagged:  # only this middleware has tags
        found["RMW_IMPLEMENTATION"] = "rmw_cyclonedds_cpp"
    return {**found, URI: xml}
