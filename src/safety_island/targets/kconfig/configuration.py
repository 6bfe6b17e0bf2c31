# SPDX-License-Identifier: Apache-2.0
"""The chosen configuration as the program uses it: every symbol of Kconfig, checked and typed.

Needs no Kconfig parser, so that a built island reads its ``.config`` without one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from ipaddress import AddressValueError, IPv4Address, IPv4Interface, NetmaskValueError

from safety_island.errors import ConfigurationError
from safety_island.targets.kconfig.fragment import PREFIX, read_lines, unquote

Value = bool | int | str
MAX_DIGITS = 18
"""Of a whole number: what 64 bits hold."""
Where = Callable[[str], str]
"""Where the value of a symbol comes from, for an error message."""


@dataclass(frozen=True)
class InterfaceConfiguration:
    """A network interface: its name, VLAN id (0: none), and static address when it has one."""

    name: str
    vlan: int
    address: IPv4Interface | None
    gateway: IPv4Address | None


@dataclass(frozen=True)
class RunConfiguration:
    """What the island runs with; one field for each symbol, and ``target``."""

    target: str
    output_mode: str
    """DDS_ONLY, CAN_ONLY or DDS_AND_CAN."""
    dds_output: bool
    can_output: bool
    can_device: str
    """Backend and channel, empty without CAN output."""
    dds_domain_id: int
    dds_network_interface: str
    """Empty: the library chooses."""
    dds_log_level: int
    """0 to 2."""
    address_limit_s: int
    """``NET_DHCPV4_INITIAL_DELAY_MAX``: longest wait for an IPv4 address."""
    interfaces: tuple[InterfaceConfiguration, ...]
    """Interfaces to configure: with a static address or a VLAN."""
    sntp_server: str | None
    """None without ``ENABLE_SNTP``."""
    log_level: int
    """0 to 2."""
    log_throttle_s: int
    thread_stack_size: int
    """Bytes."""

    @classmethod
    def from_symbols(
        cls, target: str, symbols: Mapping[str, Value], where: Where = lambda symbol: PREFIX[:-1]
    ) -> RunConfiguration:
        """Return the configuration of resolved symbols; one that is absent is n, 0 or empty.

        Raises ConfigurationError for a text that is not what it should be, such as an address.
        """
        view = _Symbols(symbols, where)
        return cls(
            target=target,
            output_mode=view.chosen("CONTROL_CMD_OUTPUT_", ("DDS_ONLY", "CAN_ONLY", "DDS_AND_CAN")),
            dds_output=view.flag("CONTROL_CMD_DDS_OUTPUT"),
            can_output=view.flag("CONTROL_CMD_CAN_OUTPUT"),
            can_device=view.needed("CAN_DEVICE") if view.flag("CAN") else "",
            dds_domain_id=view.number("DDS_DOMAIN_ID"),
            dds_network_interface=view.text("DDS_NETWORK_INTERFACE"),
            dds_log_level=view.number("DDS_LOG_LEVEL"),
            address_limit_s=view.number("NET_DHCPV4_INITIAL_DELAY_MAX"),
            interfaces=tuple(_interfaces(view)),
            sntp_server=view.needed("SNTP_SERVER") if view.flag("ENABLE_SNTP") else None,
            log_level=view.number("LOG_LEVEL"),
            log_throttle_s=view.number("LOG_THROTTLE_RATE"),
            thread_stack_size=view.number("THREAD_STACK_SIZE"),
        )


class _Symbols:
    """Typed access to resolved symbols."""

    def __init__(self, symbols: Mapping[str, Value], where: Where) -> None:
        self._symbols = symbols
        self._where = where

    def flag(self, name: str) -> bool:
        return bool(self._symbols.get(name, False))

    def number(self, name: str) -> int:
        return int(self._symbols.get(name, 0))

    def text(self, name: str) -> str:
        return str(self._symbols.get(name, ""))

    def needed(self, name: str) -> str:
        text = self.text(name)
        if not text.strip():
            raise self.wrong(name, "a name, not an empty text")
        return text

    def chosen(self, prefix: str, names: tuple[str, ...]) -> str:
        (name,) = [name for name in names if self.flag(prefix + name)] or [names[0]]
        return name

    def wrong(self, name: str, expected: str) -> ConfigurationError:
        found = f'{PREFIX}{name}="{self.text(name)}"'
        return ConfigurationError(f"{self._where(name)}: {found}: expected {expected}")


def _interfaces(view: _Symbols) -> list[InterfaceConfiguration]:
    names = {1: view.text("DDS_NETWORK_INTERFACE"), 2: view.text("NET_IFACE2_NAME")}
    found = (_interface(view, f"NET_IFACE{number}_", name) for number, name in names.items())
    return [item for item in found if item.name and (item.address is not None or item.vlan)]


def _interface(view: _Symbols, prefix: str, name: str) -> InterfaceConfiguration:
    address = _static_address(view, prefix)
    gateway = _address(view, prefix + "GW")
    if gateway is not None:
        if address is None:
            raise view.wrong(prefix + "GW", f"no gateway without {PREFIX}{prefix}ADDR")
        if gateway not in address.network or gateway == address.ip:
            raise view.wrong(prefix + "GW", f"another address inside {address.network}")
    return InterfaceConfiguration(name, view.number(prefix + "VLAN"), address, gateway)


def _static_address(view: _Symbols, prefix: str) -> IPv4Interface | None:
    address = _address(view, prefix + "ADDR")
    if address is None:
        return None
    mask = view.text(prefix + "NETMASK")
    try:
        found = IPv4Interface(f"{address}/{mask}")
    except (NetmaskValueError, AddressValueError):
        found = IPv4Interface(address)
    if str(found.netmask) != mask or found.network.prefixlen == 0:
        raise view.wrong(prefix + "NETMASK", "a netmask such as 255.255.255.0")
    ends = (found.network.network_address, found.network.broadcast_address)
    if found.network.prefixlen < 31 and address in ends:
        raise view.wrong(prefix + "ADDR", f"the address of one host inside {found.network}")
    return found


def _address(view: _Symbols, name: str) -> IPv4Address | None:
    text = view.text(name)
    if not text:
        return None
    try:
        address = IPv4Address(text)
    except AddressValueError:
        address = None
    if address is None or address.is_multicast or address.is_unspecified:
        raise view.wrong(name, "an IPv4 address such as 192.0.2.10")
    return address


def symbols_of(dotconfig: str, name: str = ".config") -> dict[str, Value]:
    """Return the symbols in the text of a ``.config``.

    Raises ConfigurationError for a line that none has; ``name`` is how its place is told.
    """
    found: dict[str, Value] = {}
    for symbol, value, place in read_lines(dotconfig, name):
        text = unquote(value)
        if value in ("y", "n"):
            found[symbol] = value == "y"
        elif text is not None:
            found[symbol] = text
        elif value.isascii() and value.isdigit() and len(value) <= MAX_DIGITS:
            found[symbol] = int(value)
        else:
            raise ConfigurationError(f"{place}: {PREFIX}{symbol}={value}: not a value of a .config")
    return found
