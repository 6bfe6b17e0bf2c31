# SPDX-License-Identifier: Apache-2.0
"""Options and configuration of ``island run``: each does something or is refused."""

from __future__ import annotations

from ipaddress import IPv4Address, IPv4Interface

import pytest

from safety_island.can.spec import BusSpec
from safety_island.can.targets import TARGET_OUTPUT
from safety_island.cli import run
from safety_island.cli.configuration import resolved, run_configuration
from safety_island.cli.parser import Parser
from safety_island.cli.run_settings import HOSTED, RunSettings, run_settings
from safety_island.command.mode import OutputMode
from safety_island.dds.config import DdsConfig
from safety_island.errors import ConfigurationError
from safety_island.platform import LogConfig, LogLevel
from safety_island.targets.kconfig.targets import NAMES


def settings(*words: str) -> RunSettings:
    parser = Parser(prog="island run")
    run.configure(parser)
    arguments = parser.parse(list(words))
    return run_settings(arguments, run_configuration(resolved(arguments)))


@pytest.fixture(autouse=True)
def no_user_xml(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("CYCLONEDDS_URI", raising=False)


def test_defaults() -> None:
    assert settings() == RunSettings(
        target="posix",
        domain_id=2,
        dds=DdsConfig(interface="lo", log_level=0),
        interfaces=(),
        address_limit_s=10,
        sntp_server=None,
        mode=OutputMode.DDS_ONLY,
        can=None,
        can_log=None,
        log=LogConfig(LogLevel.NORMAL, throttle_s=3.0, json=False),
        thread_stack_size=262144,
    )


@pytest.mark.parametrize("target", NAMES)
def test_mode_and_bus_of_a_target(target: str) -> None:
    found = settings("-t", target, "--interface", "lo")
    row = TARGET_OUTPUT[target]
    assert found.mode is row.mode
    assert (str(found.can) if found.can else None) == row.can


def test_each_symbol_arrives() -> None:
    words = ["LOG_LEVEL=2", "LOG_THROTTLE_RATE=7", "DDS_LOG_LEVEL=1", "DDS_DOMAIN_ID=9"]
    words += ["DDS_NETWORK_INTERFACE=tap0", "THREAD_STACK_SIZE=524288", "ENABLE_SNTP=y"]
    words += ["SNTP_SERVER=ntp.example:1123", "NET_DHCPV4_INITIAL_DELAY_MAX=4"]
    words += ["NET_IFACE1_ADDR=192.0.2.5", "NET_IFACE1_GW=192.0.2.1", "NET_IFACE1_VLAN=12"]
    words += ["NET_IFACE2_NAME=eth1", "NET_IFACE2_VLAN=3", "CONTROL_CMD_OUTPUT_CAN_ONLY=y"]
    words += ["CAN_DEVICE=virtual:bench"]
    found = settings(*(part for word in words for part in ("-D", word)))
    assert found.log == LogConfig(LogLevel.DEBUG, throttle_s=7)
    assert (found.domain_id, found.thread_stack_size) == (9, 524288)
    assert found.dds == DdsConfig(interface="tap0", log_level=1)
    assert (found.sntp_server, found.address_limit_s) == ("ntp.example:1123", 4)
    assert (found.mode, found.can) == (OutputMode.CAN_ONLY, BusSpec("virtual", "bench"))
    first, second = found.interfaces
    assert (first.name, first.vlan) == ("tap0", 12)
    assert first.address == IPv4Interface("192.0.2.5/24")
    assert first.gateway == IPv4Address("192.0.2.1")
    assert (second.name, second.vlan, second.address) == ("eth1", 3, None)


def test_options_win_over_the_configuration() -> None:
    words = ["-D", "DDS_DOMAIN_ID=9", "-D", "DDS_NETWORK_INTERFACE=tap0", "-D", "ENABLE_SNTP=y"]
    words += ["-D", "NET_IFACE1_ADDR=192.0.2.5"]
    words += ["--domain", "3", "--interface", "eth5", "--sntp", "10.0.0.1", "--log-json"]
    words += ["-t", "freertos_posix", "--mode", "CAN_ONLY", "--can", "virtual:x"]
    found = settings(*words)
    assert (found.domain_id, found.dds.interface, found.sntp_server) == (3, "eth5", "10.0.0.1")
    assert [item.name for item in found.interfaces] == ["eth5"]
    assert (found.mode, found.can) == (OutputMode.CAN_ONLY, BusSpec("virtual", "x"))
    assert found.log.json


def test_a_bus_without_a_mode_adds_can_to_dds() -> None:
    assert settings("--can", "mock").mode is OutputMode.DDS_AND_CAN
    assert settings("--mode", "CAN_ONLY", "--can", "mock").mode is OutputMode.CAN_ONLY


def test_can_bus_without_a_name() -> None:
    assert settings("--mode", "CAN_ONLY").can is None
    assert settings("-D", "CONTROL_CMD_OUTPUT_CAN_ONLY=y").can == BusSpec("socketcan", "can0")


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--mode", "DDS_ONLY", "--can", "mock"], "--can mock: output mode DDS_ONLY"),
        (["--can-log", "x.log"], "--can-log x.log: output mode DDS_ONLY"),
        (["--platform", "sim", "--sntp", "a"], "asks no server"),
        (["--platform", "sim", "--can", "socketcan:can0"], "no real bus, expected --can mock"),
        *(
            (["--platform", "sim", *words], f"{words[0]}: --platform sim")
            for words in (
                ["--domain", "3"],
                ["--interface", "lo"],
                ["--peer", "10.0.0.2"],
                ["--domain-tag", "a"],
                ["--realtime", "off"],
                ["--realtime", "require"],
                ["--cpu", "1"],
            )
        ),
        (["--course", "slalom"], "--course: --platform posix drives"),
        (["--path", "a.csv"], "--path: --platform posix drives"),
        (["--platform", "sim", "--course", "hill", "--path", "a"], "--course and --path"),
        (["--realtime", "off", "--cpu", "1"], "no core is chosen"),
        (["-t", "nosuch"], "unknown target 'nosuch'"),
    ],
)
def test_refused(words: list[str], text: str) -> None:
    with pytest.raises(ConfigurationError, match=text):
        settings(*words)


@pytest.mark.parametrize("target", [name for name in NAMES if name not in HOSTED])
def test_a_boards_interface_is_not_this_machines(target: str) -> None:
    with pytest.raises(ConfigurationError, match=f"'{target}' uses its board's interface 'etherne"):
        settings("-t", target)
    assert settings("-t", target, "--platform", "sim", "--can", "mock").dds.interface is None


def test_the_users_own_xml_chooses_the_interface(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CYCLONEDDS_URI", "<CycloneDDS/>")
    assert settings("-t", "fvp_baser_aemv8r_smp").dds.interface is None
    assert settings("--interface", "eth7").dds.interface == "eth7"


def test_virtual_time_needs_no_network() -> None:
    plain = settings("--platform", "sim")
    words = ("-D", "ENABLE_SNTP=y", "-D", "NET_IFACE1_ADDR=192.0.2.5")
    assert settings("--platform", "sim", *words) == plain
