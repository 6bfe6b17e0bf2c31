# SPDX-License-Identifier: Apache-2.0
"""Options that several commands share, so that each is spelt, checked and explained once."""

from __future__ import annotations

import argparse
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, TypedDict

if TYPE_CHECKING:
    from safety_island.dds.config import DdsConfig

MAX_DOMAIN = 232
"""The highest DDS domain id whose UDP ports exist."""
MAX_INTERFACE = 15
"""Bytes of the longest name of an interface (Linux: IFNAMSIZ without its final zero)."""


class PeersAndTags(TypedDict):
    """Settings of ``DdsConfig`` that hold with a user's own XML too."""

    peers: tuple[str, ...]
    domain_tag: str
    domain_tags: tuple[tuple[int, str], ...]


def domain_id(text: str) -> int:
    """Read a DDS domain id, 0 to 232."""
    if not text.isascii() or not text.isdigit() or int(text) > MAX_DOMAIN:
        raise argparse.ArgumentTypeError(
            f"'{text}' is not a DDS domain id: a whole number from 0 to {MAX_DOMAIN}"
        )
    return int(text)


def interface(text: str) -> str:
    """Read the name of a network interface; the kernel gives none another form than this."""
    is_name = 0 < len(text.encode(errors="replace")) <= MAX_INTERFACE
    wrong = any(c in "/:" or c.isspace() or not c.isprintable() for c in text)
    if not is_name or wrong or text in (".", ".."):
        raise argparse.ArgumentTypeError(
            f"{text!r} is not a name of an interface: 1 to {MAX_INTERFACE} characters"
            " without spaces, '/' and ':', for example eth0 (ip link shows those of this machine)"
        )
    return text


def period_s(text: str) -> float:
    """Read a control period in seconds, 1 ms to 1 s."""
    return _seconds(text, 0.001, 1.0, "a period in seconds, for example 0.15")


def duration_s(text: str) -> float:
    """Read a duration in seconds; 0 means without end."""
    return _seconds(text, 0.0, 1e9, "a duration in seconds, 0 for no end")


def timeout_s(text: str) -> float:
    """Read a time-out in seconds, 10 ms to an hour."""
    return _seconds(text, 0.01, 3600.0, "a time-out in seconds, for example 3")


def cpu(text: str) -> str:
    """Read which processor core the control thread runs on."""
    from safety_island.errors import ConfigurationError
    from safety_island.platform.posix.real_time import parse_cpu

    try:
        return parse_cpu(text)
    except ConfigurationError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _seconds(text: str, low: float, high: float, meaning: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not isfinite(value) or not low <= value <= high:
        raise argparse.ArgumentTypeError(f"'{text}' is not {meaning} ({low:g} to {high:g})")
    return value


def add_domain(parser: argparse.ArgumentParser, default: int, whose: str) -> None:
    """Add ``--domain``."""
    parser.add_argument(
        "--domain",
        type=domain_id,
        default=default,
        metavar="ID",
        help=f"DDS domain of {whose} (default: {default})",
    )


def domain_tag(text: str) -> tuple[int | None, str]:
    """Read a domain tag, ``TAG`` or ``ID=TAG`` for one domain."""
    before, separator, tag = text.partition("=")
    if not separator:
        return None, text
    return domain_id(before), tag


def add_network(parser: argparse.ArgumentParser) -> None:
    """Add what says how DDS uses the network; ``dds_config`` reads it."""
    add_interface(parser)
    add_peers_and_tag(parser)
    add_library(parser)


def add_interface(parser: argparse.ArgumentParser) -> None:
    """Add ``--interface``."""
    parser.add_argument(
        "--interface",
        type=interface,
        default="lo",
        metavar="NAME",
        help="network interface, for example eth0 or tap0 (default: lo, this machine only; "
        "CYCLONEDDS_URI, when set, configures DDS instead)",
    )


def add_peers_and_tag(parser: argparse.ArgumentParser) -> None:
    """Add ``--peer`` and ``--domain-tag``."""
    parser.add_argument(
        "--peer",
        action="append",
        default=[],
        metavar="ADDRESS",
        help="another machine to find without multicast, by address or name, with an optional "
        ":port; may be repeated (it needs --interface as well)",
    )
    parser.add_argument(
        "--domain-tag",
        action="append",
        type=domain_tag,
        default=[],
        metavar="[ID=]TAG",
        help="keep apart from participants of the same domain with another tag, or none; ID=TAG "
        "for one domain alone",
    )


def add_library(parser: argparse.ArgumentParser) -> None:
    """Add ``--ddsc``."""
    parser.add_argument(
        "--ddsc",
        type=Path,
        metavar="PATH",
        help="CycloneDDS's C library, libddsc.so of release 0.10 or 11, or its folder (default: "
        "SAFETY_ISLAND_DDSC, else that of the package cyclonedds, of the system, of ROS 2)",
    )


def dds_config(arguments: argparse.Namespace) -> DdsConfig:
    """Return how DDS uses the network, as the options of ``add_network`` say."""
    from safety_island.dds.config import DdsConfig

    settings = peers_and_tags(arguments)
    return DdsConfig(interface=arguments.interface, library=arguments.ddsc, **settings)


def peers_and_tags(arguments: argparse.Namespace) -> PeersAndTags:
    """Return the settings of ``add_peers_and_tag``; the last of several tags counts."""
    tags = dict(arguments.domain_tag)
    return PeersAndTags(
        peers=tuple(arguments.peer),
        domain_tag=tags.pop(None, ""),
        domain_tags=tuple(tags.items()),
    )


def add_params(parser: argparse.ArgumentParser) -> None:
    """Add ``--params``."""
    parser.add_argument(
        "--params",
        nargs="+",
        default=["default"],
        metavar="FILE",
        help="a parameter set by name (default, firmware, autoware-0.40) and Autoware parameter "
        "files that change it, later ones winning",
    )


def add_period(parser: argparse.ArgumentParser) -> None:
    """Add ``--period``."""
    parser.add_argument(
        "--period",
        type=period_s,
        metavar="SECONDS",
        help="control period; overrides ctrl_period of the parameters (0.15 in the default set)",
    )


def add_duration(parser: argparse.ArgumentParser, default: float) -> None:
    """Add ``--duration``."""
    shown = f"{default:g}" if default else "0, no end"
    parser.add_argument(
        "--duration",
        type=duration_s,
        default=default,
        metavar="SECONDS",
        help=f"stop after this time; 0 runs on (default: {shown})",
    )


def add_timeout(parser: argparse.ArgumentParser, what: str) -> None:
    """Add ``--timeout``."""
    parser.add_argument(
        "--timeout",
        type=timeout_s,
        default=3.0,
        metavar="SECONDS",
        help=f"longest wait for {what} (default: 3)",
    )


def add_realtime(parser: argparse.ArgumentParser) -> None:
    """Add ``--realtime`` and ``--cpu``."""
    parser.add_argument(
        "--realtime",
        choices=("auto", "require", "off"),
        default="auto",
        help="fixed priority (SCHED_FIFO), a core and locked memory: auto takes what this user may "
        "have and says what is missing, require ends the start without all of it (default: auto)",
    )
    parser.add_argument(
        "--cpu",
        type=cpu,
        default="auto",
        metavar="CORE",
        help="core of the control thread with --realtime: a number, any (the system chooses), or "
        "auto, an isolated one or one of the last (default: auto)",
    )


def check_realtime(arguments: argparse.Namespace) -> None:
    """Raise ConfigurationError for a core that no thread would be pinned to."""
    from safety_island.errors import ConfigurationError

    if arguments.realtime == "off" and arguments.cpu != "auto":
        raise ConfigurationError(
            "--cpu: with --realtime off no core is chosen; drop one of the two options"
        )


def add_json(parser: argparse.ArgumentParser, what: str) -> None:
    """Add ``--json``."""
    parser.add_argument("--json", action="store_true", help=f"print {what} as JSON")
