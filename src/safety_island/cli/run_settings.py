# SPDX-License-Identifier: Apache-2.0
"""What ``island run`` runs with: the configuration of the target, and the options that win over it.

Every symbol of Kconfig ends here in something that the program uses.
"""

from __future__ import annotations

import argparse
import socket
from dataclasses import dataclass, replace
from pathlib import Path

from safety_island.can.spec import BusSpec, parse_spec
from safety_island.can.targets import TARGET_OUTPUT
from safety_island.cli.options import check_realtime, peers_and_tags
from safety_island.command.mode import OutputMode
from safety_island.dds.config import URI, DdsConfig, user_xml
from safety_island.errors import ConfigurationError
from safety_island.platform import LogConfig, LogLevel
from safety_island.targets.kconfig.configuration import InterfaceConfiguration, RunConfiguration

HOSTED = ("freertos_posix", "posix")
"""Targets whose machine is the one that 'island run' runs on; the others name a board's devices."""
IN_MEMORY = ("mock", "virtual")
"""CAN backends without a wire: what virtual time can use."""


_NO_NETWORK, _OWN_VEHICLE = "keeps its topics in memory", "drives the vehicle that its inputs show"
_IDLE: dict[str, dict[str, str]] = {
    "sim": {
        "--domain": _NO_NETWORK,
        "--interface": _NO_NETWORK,
        "--peer": _NO_NETWORK,
        "--domain-tag": _NO_NETWORK,
        "--ddsc": _NO_NETWORK,
        "--sntp": "has virtual time and asks no server",
        "--realtime": "has virtual time",
        "--cpu": "has virtual time",
    },
    "posix": {"--course": _OWN_VEHICLE, "--path": _OWN_VEHICLE},
}
"""Options that do nothing on a platform, and why."""


@dataclass(frozen=True)
class RunSettings:
    """The settings of one run; times in seconds, the stack in bytes."""

    target: str
    domain_id: int
    dds: DdsConfig
    interfaces: tuple[InterfaceConfiguration, ...]
    """Interfaces to configure before DDS starts."""
    address_limit_s: float
    sntp_server: str | None
    mode: OutputMode
    can: BusSpec | None
    can_log: Path | None
    log: LogConfig
    thread_stack_size: int


def run_settings(arguments: argparse.Namespace, config: RunConfiguration) -> RunSettings:
    """Return the settings; options that are None leave the configuration as it is.

    Raises ConfigurationError for options that contradict each other or the machine.
    """
    is_virtual = arguments.platform == "sim"
    _refuse_idle(arguments)
    mode, bus = _output(arguments, config, is_virtual)
    interface = None if is_virtual else _interface(arguments.interface, config)
    return RunSettings(
        target=config.target,
        domain_id=config.dds_domain_id if arguments.domain is None else arguments.domain,
        dds=DdsConfig(
            interface,
            log_level=config.dds_log_level,
            library=arguments.ddsc,
            **peers_and_tags(arguments),
        ),
        interfaces=() if is_virtual else tuple(_configured(config, interface)),
        address_limit_s=config.address_limit_s,
        sntp_server=None if is_virtual else arguments.sntp or config.sntp_server,
        mode=mode,
        can=bus,
        can_log=None if arguments.can_log is None else Path(arguments.can_log),
        log=LogConfig(LogLevel(config.log_level), config.log_throttle_s, arguments.log_json),
        thread_stack_size=config.thread_stack_size,
    )


def _refuse_idle(arguments: argparse.Namespace) -> None:
    """Raise ConfigurationError for an option that would do nothing."""
    idle = _IDLE[arguments.platform]
    for option, why in idle.items():
        value = getattr(arguments, option.lstrip("-").replace("-", "_"))
        if value not in (None, [], "auto"):
            raise ConfigurationError(
                f"{option}: --platform {arguments.platform} {why}; drop one of the two options"
            )
    if arguments.course is not None and arguments.path is not None:
        raise ConfigurationError("--course and --path: one vehicle drives one of them; drop one")
    check_realtime(arguments)


def _output(
    arguments: argparse.Namespace, config: RunConfiguration, is_virtual: bool
) -> tuple[OutputMode, BusSpec | None]:
    """Return output mode and CAN bus; a bus that is asked for without a mode adds CAN to DDS."""
    mode = OutputMode[arguments.mode or config.output_mode]
    if arguments.can is not None and arguments.mode is None and not mode.uses_can:
        mode = OutputMode.DDS_AND_CAN
    if not mode.uses_can:
        for option, value in (("--can", arguments.can), ("--can-log", arguments.can_log)):
            if value is not None:
                raise ConfigurationError(
                    f"{option} {value}: output mode {mode.name} sends no CAN frames; "
                    "add --mode DDS_AND_CAN or --mode CAN_ONLY"
                )
        return mode, None
    name = arguments.can or config.can_device or TARGET_OUTPUT[config.target].can
    bus = parse_spec(name) if name else None
    if is_virtual and bus is not None and bus.backend not in IN_MEMORY:
        raise ConfigurationError(
            f"--can {bus}: virtual time (--platform sim) has no real bus, expected --can mock"
        )
    return mode, bus


def _interface(option: str | None, config: RunConfiguration) -> str | None:
    """Return the interface of DDS; None: the library, or the user's own XML, chooses."""
    name = option or config.dds_network_interface
    if option is not None or not name:
        return name or None
    if user_xml() is not None:
        return None
    here = [known for _, known in socket.if_nameindex()]
    if config.target not in HOSTED and name not in here:
        raise ConfigurationError(
            f"target '{config.target}' uses its board's interface '{name}', and this machine has "
            f"{', '.join(here)}: name one with --interface, -D DDS_NETWORK_INTERFACE or {URI}"
        )
    return name


def _configured(config: RunConfiguration, interface: str | None) -> list[InterfaceConfiguration]:
    """Return the interfaces to configure: the first is that of DDS, however it is named."""
    return [
        replace(item, name=interface)
        if interface and item.name == config.dds_network_interface
        else item
        for item in config.interfaces
    ]
