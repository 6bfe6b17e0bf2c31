# SPDX-License-Identifier: Apache-2.0
"""``island bridge``: forwards topics between DDS domains, as ROS 2's ``domain_bridge`` does."""

from __future__ import annotations

import argparse
from pathlib import Path

from safety_island.cli import options
from safety_island.cli.jsonlines import JsonLines
from safety_island.cli.parser import teach
from safety_island.cli.stopping import StopAtOnce
from safety_island.cli.tell import tell, tell_lost

SHIPPED = Path(__file__).parents[1] / "demo" / "bridge" / "bridge-config.yaml"
"""The bridge file of the contract; ``demo/bridge`` of a checkout is a link to its folder."""
SWITCH = {"true": True, "false": False}


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    teach(
        parser,
        """
Forward topics from one DDS domain to another, as the file says (the schema of ROS 2's
domain_bridge). Messages pass as bytes: no type needs to be known. A route opens when its publisher
is there, with its reliability and durability; who comes later changes nothing for those who are
there. A publisher that goes, and a message that is disposed, are gone beyond the bridge as well. A
bridge does not forward what it published itself. Without a file it forwards the island's six topics
between domains 1 and 2.
""",
        ("island bridge", "the island's six topics, domains 1 and 2"),
        ("island bridge --from 7 --to 8 my.yaml", "other domains than in the file"),
        ("island bridge --interface tap0 a.yaml b.yaml", "two files, on a network"),
    )
    parser.add_argument(
        "config",
        nargs="*",
        metavar="CONFIG",
        default=[str(SHIPPED)],
        help=f"bridge file (YAML; default: {SHIPPED})",
    )
    parser.add_argument(
        "--from",
        dest="from_domain",
        type=options.domain_id,
        metavar="ID",
        help="domain to read from, in place of every from_domain of the files",
    )
    parser.add_argument(
        "--to",
        dest="to_domain",
        type=options.domain_id,
        metavar="ID",
        help="domain to write to, in place of every to_domain of the files",
    )
    parser.add_argument(
        "--mode",
        choices=("normal", "compress", "decompress"),
        help="in place of the mode of the files",
    )
    _add_switch(parser, "--wait-for-subscription", "false", "open a route only when it is read")
    _add_switch(parser, "--wait-for-publisher", "true", "open a route only when it is written")
    parser.add_argument(
        "--auto-remove",
        nargs="?",
        const="true",
        default="false",
        choices=tuple(SWITCH),
        help="close a route again when what it waited for is gone (default: false)",
    )
    options.add_network(parser)
    options.add_realtime(parser)
    options.add_duration(parser, 0.0)
    options.add_json(parser, "counts, once a second,")


def _add_switch(parser: argparse.ArgumentParser, name: str, default: str, what: str) -> None:
    parser.add_argument(
        name,
        nargs="?",
        const="true",
        default=default,
        choices=tuple(SWITCH),
        help=f"{what} (default: {default})",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Forward until told to stop."""
    options.check_realtime(arguments)
    with StopAtOnce() as start:
        from safety_island.bridge import BridgeOptions, run
        from safety_island.bridge.link import WaitFor
        from safety_island.cli.bridge_service import BridgeService
        from safety_island.cli.start_again import start_again
        from safety_island.platform import load

        chosen = BridgeOptions(
            from_domain=arguments.from_domain,
            to_domain=arguments.to_domain,
            mode=arguments.mode,
            wait_for=WaitFor(
                publisher=SWITCH[arguments.wait_for_publisher],
                subscription=SWITCH[arguments.wait_for_subscription],
                auto_remove=SWITCH[arguments.auto_remove],
            ),
            dds=options.dds_config(arguments),
            duration_s=arguments.duration,
        )
        stop = BridgeService(arguments.realtime, arguments.cpu)
        report = JsonLines(tell_lost).write if arguments.json else None
        with load("posix").on_stop(stop.set):
            start.disarm()
            code = run(arguments.config, chosen, stop, report, tell)
        if stop.must_rejoin:
            start_again()
        return code
