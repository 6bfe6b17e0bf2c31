# SPDX-License-Identifier: Apache-2.0
"""``island can``: watch the command frames, send one by hand, write and check the DBC file."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import cast

from safety_island.cli import can_dbc, can_monitor, can_send
from safety_island.cli.parser import teach


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the actions and their arguments."""
    teach(
        parser,
        """
The command frames 0x100, 0x101 and 0x102 on a CAN bus. A bus is named BACKEND[:CHANNEL], with
options after commas: socketcan:can0, slcan:/dev/ttyACM0,bitrate=500000, virtual:bench,
udp_multicast:239.74.163.2, or any other interface of python-can.
""",
        ("island can monitor --can socketcan:can0", "watch a live bus"),
        ("island can monitor drive.log", "decode a log of 'candump -L' (or .asc, .blf)"),
        ("candump -L can0 | island can monitor -", "decode what candump hears"),
        ("island can send --angle 0.1 --velocity 2 --can socketcan:can0", "send one command"),
        ("island can send --angle 0.1 --velocity 2 --print", "show its frames, send nothing"),
        ("island can dbc --output safety_island.dbc", "write the DBC file"),
        ("island can dbc --check mine.dbc", "compare a DBC file with the encoder"),
    )
    actions = parser.add_subparsers(dest="action", metavar="ACTION", required=True)
    can_monitor.configure(actions.add_parser("monitor", help="decode a live bus or a log"))
    can_send.configure(actions.add_parser("send", help="send one command, or print its frames"))
    can_dbc.configure(actions.add_parser("dbc", help="write or check the DBC file"))
    can_dbc.configure_tables(actions.add_parser("tables", help="print the tables of docs/can.md"))


def execute(arguments: argparse.Namespace) -> int:
    """Do what was asked; return the exit code."""
    run = cast(Callable[[argparse.Namespace], int], arguments.run)
    return run(arguments)
