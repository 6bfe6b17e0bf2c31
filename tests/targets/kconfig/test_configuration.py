# SPDX-License-Identifier: Apache-2.0
"""The configuration as the program uses it: each symbol counts, and texts are checked."""

from ipaddress import IPv4Address, IPv4Interface

import pytest

from safety_island.errors import ConfigurationError
from safety_island.targets.kconfig.configuration import (
    InterfaceConfiguration,
    RunConfiguration,
    symbols_of,
)
from safety_island.targets.kconfig.places import Places
from safety_island.targets.kconfig.resolve import resolve
from safety_island.targets.kconfig.targets import NAMES

CAN = "CONTROL_CMD_OUTPUT_DDS_AND_CAN=y"
ADDRESS_1 = "NET_IFACE1_ADDR=192.0.2.10"
NAME_2 = "NET_IFACE2_NAME=eth1"
ADDRESS_2 = "NET_IFACE2_ADDR=198.51.100.7"

EFFECTS = {
    "CONTROL_CMD_OUTPUT_DDS_ONLY": (["CONTROL_CMD_OUTPUT_CAN_ONLY=y"], "y"),
    "CONTROL_CMD_OUTPUT_CAN_ONLY": ([], "y"),
    "CONTROL_CMD_OUTPUT_DDS_AND_CAN": ([], "y"),
    "CAN_DEVICE": ([CAN], "virtual:bench"),
    "DDS_DOMAIN_ID": ([], "7"),
    "DDS_NETWORK_INTERFACE": ([], "eth0"),
    "DDS_LOG_LEVEL": ([], "2"),
    "NET_DHCPV4_INITIAL_DELAY_MAX": ([], "3"),
    "NET_IFACE1_ADDR": ([], "192.0.2.10"),
    "NET_IFACE1_NETMASK": ([ADDRESS_1], "255.255.0.0"),
    "NET_IFACE1_GW": ([ADDRESS_1], "192.0.2.1"),
    "NET_IFACE1_VLAN": ([], "12"),
    "NET_IFACE2_NAME": ([NAME_2, ADDRESS_2], "eth2"),
    "NET_IFACE2_ADDR": ([NAME_2], "198.51.100.7"),
    "NET_IFACE2_NETMASK": ([NAME_2, ADDRESS_2], "255.255.0.0"),
    "NET_IFACE2_GW": ([NAME_2, ADDRESS_2], "198.51.100.1"),
    "NET_IFACE2_VLAN": ([NAME_2], "4094"),
    "ENABLE_SNTP": ([], "y"),
    "SNTP_SERVER": (["ENABLE_SNTP=y"], "time.example.org"),
    "LOG_LEVEL": ([], "2"),
    "LOG_THROTTLE_RATE": ([], "9"),
    "THREAD_STACK_SIZE": ([], "131072"),
}
"""For each symbol with a prompt: what it needs, and a value other than its default."""


def chosen(places: Places, *overrides: str, target: str = "posix") -> RunConfiguration:
    found = resolve(target, (), overrides, places)
    origins = found.origins()
    return RunConfiguration.from_symbols(target, found.values(), origins.__getitem__)


def test_every_symbol_that_can_be_set_is_in_the_table(places: Places) -> None:
    settings = resolve("posix", places=places).settings
    assert {item.symbol for item in settings if not item.origin.startswith("follows")} == set(
        EFFECTS
    )


@pytest.mark.parametrize("symbol", EFFECTS)
def test_no_symbol_is_decoration(symbol: str, places: Places) -> None:
    needed, value = EFFECTS[symbol]
    assert chosen(places, *needed) != chosen(places, *needed, f"{symbol}={value}")


@pytest.mark.parametrize("target", NAMES)
def test_dotconfig_gives_the_same_configuration(target: str, places: Places) -> None:
    overrides = [CAN, ADDRESS_1, NAME_2, ADDRESS_2, "ENABLE_SNTP=y", "NET_IFACE1_VLAN=12"]
    text = resolve(target, (), overrides, places).dotconfig()
    expected = chosen(places, *overrides, target=target)
    assert RunConfiguration.from_symbols(target, symbols_of(text)) == expected


def test_defaults(places: Places) -> None:
    assert chosen(places) == RunConfiguration(
        target="posix",
        output_mode="DDS_ONLY",
        dds_output=True,
        can_output=False,
        can_device="",
        dds_domain_id=2,
        dds_network_interface="lo",
        dds_log_level=0,
        address_limit_s=10,
        interfaces=(),
        sntp_server=None,
        log_level=1,
        log_throttle_s=3,
        thread_stack_size=262144,
    )


def test_static_addresses_and_vlan(places: Places) -> None:
    found = chosen(
        places,
        ADDRESS_1,
        "NET_IFACE1_GW=192.0.2.1",
        "NET_IFACE1_VLAN=12",
        NAME_2,
        "NET_IFACE2_VLAN=7",
    )
    assert found.interfaces == (
        InterfaceConfiguration("lo", 12, IPv4Interface("192.0.2.10/24"), IPv4Address("192.0.2.1")),
        InterfaceConfiguration("eth1", 7, None, None),
    )


@pytest.mark.parametrize(
    ("overrides", "told"),
    [
        (["NET_IFACE1_ADDR=192.0.2.300"], "expected an IPv4 address such as 192.0.2.10"),
        (["NET_IFACE1_ADDR=tap0"], "expected an IPv4 address such as 192.0.2.10"),
        (["NET_IFACE1_ADDR=224.0.0.1"], "expected an IPv4 address such as 192.0.2.10"),
        (["NET_IFACE1_ADDR=0.0.0.0"], "expected an IPv4 address such as 192.0.2.10"),
        (["NET_IFACE1_ADDR=::1"], "expected an IPv4 address such as 192.0.2.10"),
        (["NET_IFACE1_ADDR=192.0.2.255"], "expected the address of one host inside 192.0.2.0/24"),
        ([ADDRESS_1, "NET_IFACE1_NETMASK=255.0.255.0"], "expected a netmask such as"),
        ([ADDRESS_1, "NET_IFACE1_NETMASK=0.0.0.255"], "expected a netmask such as"),
        ([ADDRESS_1, "NET_IFACE1_NETMASK=24"], "expected a netmask such as 255.255.255.0"),
        ([ADDRESS_1, "NET_IFACE1_NETMASK="], "expected a netmask such as 255.255.255.0"),
        ([ADDRESS_1, "NET_IFACE1_NETMASK=0.0.0.0"], "expected a netmask such as 255.255.255.0"),
        ([ADDRESS_1, "NET_IFACE1_GW=192.0.3.1"], "expected another address inside 192.0.2.0/24"),
        ([ADDRESS_1, "NET_IFACE1_GW=192.0.2.10"], "expected another address inside 192.0.2.0/24"),
        (["ENABLE_SNTP=y", "SNTP_SERVER="], "expected a name, not an empty text"),
        ([CAN, "CAN_DEVICE= "], "expected a name, not an empty text"),
    ],
)
def test_text_that_cannot_work_is_told_with_its_place(
    overrides: list[str], told: str, places: Places
) -> None:
    with pytest.raises(ConfigurationError) as raised:
        chosen(places, *overrides)
    text = str(raised.value)
    assert text.startswith(f"-D {overrides[-1]}: CONFIG_")
    assert text.endswith(told) or f"{told}" in text


@pytest.mark.parametrize("line", ["CONFIG_LOG_LEVEL=two", "LOG_LEVEL=1"])
def test_line_that_no_dotconfig_has_is_told(line: str) -> None:
    with pytest.raises(ConfigurationError, match=r"^\.config:2: "):
        symbols_of(f"# head\n{line}\n")
