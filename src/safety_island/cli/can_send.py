# SPDX-License-Identifier: Apache-2.0
"""``island can send``: one command by hand."""

from __future__ import annotations

import argparse
import re
import sys
from decimal import Decimal, InvalidOperation

from safety_island.can.command import Command
from safety_island.can.encoder import Rejection, Triple, encode
from safety_island.can.receiver import SEQUENCE_MODULUS
from safety_island.cli.can_monitor import DEFAULT_BUS
from safety_island.command.mode import OutputMode
from safety_island.errors import IslandError

_NS_PER_S = 1_000_000_000
_LATEST_S = 1 << 32
"""A stamp counts seconds in 32 bits."""
# What argparse may take for a value although it begins with a dash: also -1e-3, -inf and -nan.
_NEGATIVE = re.compile(r"^-(\d+\.?\d*|\.\d+|inf|nan)(e[-+]?\d+)?$", re.IGNORECASE)
_VALUES = (
    ("angle", "steering tire angle [rad]; left out: 0"),
    ("rate", "steering tire rotation rate [rad/s]; left out: 0, and undefined"),
    ("velocity", "velocity [m/s]; left out: 0"),
    ("acceleration", "acceleration [m/s^2]; left out: 0, and undefined"),
    ("jerk", "jerk [m/s^3]: no frame carries it, only a flag; left out: undefined"),
)


class RejectedError(IslandError):
    """A command that no frame can carry."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser._negative_number_matcher = _NEGATIVE
    for name, what in _VALUES:
        parser.add_argument(f"--{name}", type=float, metavar="X", help=what)
    parser.add_argument(
        "--mode",
        choices=[mode.name for mode in OutputMode],
        default=OutputMode.CAN_ONLY.name,
        help="output mode in the status frame (default: CAN_ONLY)",
    )
    parser.add_argument(
        "--sequence", type=_sequence, default=0, metavar="N", help="0 to 65535 (default: 0)"
    )
    parser.add_argument(
        "--stamp", type=_stamp_ns, default=0, metavar="SECONDS", help="stamp (default: 0)"
    )
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        "--can", default=DEFAULT_BUS, metavar="BUS", help=f"the bus (default: {DEFAULT_BUS})"
    )
    where.add_argument(
        "--print", action="store_true", help="print the frames as cansend takes them, send nothing"
    )
    parser.set_defaults(run=execute)


def execute(arguments: argparse.Namespace) -> int:
    """Send the three frames, or print them. Raises RejectedError and CanError."""
    mode = OutputMode[arguments.mode]
    frames = encode(_command(arguments), mode, arguments.sequence, arguments.stamp)
    if isinstance(frames, Rejection):
        raise RejectedError(f"command rejected, no frame exists: {frames.describe()}")
    if not frames:
        print(f"island: output mode {mode.name} sends no CAN frame", file=sys.stderr)
    elif arguments.print:
        _print(frames)
    else:
        _send(arguments.can, frames)
    return 0


def _command(arguments: argparse.Namespace) -> Command:
    return Command(
        steering_tire_angle=arguments.angle or 0.0,
        steering_tire_rotation_rate=arguments.rate or 0.0,
        velocity=arguments.velocity or 0.0,
        acceleration=arguments.acceleration or 0.0,
        jerk=arguments.jerk or 0.0,
        is_defined_steering_tire_rotation_rate=arguments.rate is not None,
        is_defined_acceleration=arguments.acceleration is not None,
        is_defined_jerk=arguments.jerk is not None,
    )


def _print(frames: Triple) -> None:
    from safety_island.can.candump import format_frame

    for frame in frames:
        print(format_frame(frame))


def _send(bus: str, frames: Triple) -> None:
    from safety_island.can.live import send_once
    from safety_island.can.spec import parse_spec
    from safety_island.platform.posix.clock import PosixClock

    spec = parse_spec(bus)
    send_once(spec, frames, PosixClock().monotonic_ns)
    print(f"sent {len(frames)} frames on {spec}")


def _sequence(text: str) -> int:
    if not text.isascii() or not text.isdigit() or int(text) >= SEQUENCE_MODULUS:
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number from 0 to 65535")
    return int(text)


def _stamp_ns(text: str) -> int:
    try:
        stamp = Decimal(text)
        if 0 <= stamp <= _LATEST_S:
            return int(stamp * _NS_PER_S)
    except InvalidOperation:
        pass
    raise argparse.ArgumentTypeError(f"'{text}' is not a stamp in seconds, for example 12.345")
