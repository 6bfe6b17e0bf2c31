# SPDX-License-Identifier: Apache-2.0
"""The shipped bridge file and CycloneDDS configuration."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

from safety_island.bridge.config_file import read_bridge_file
from safety_island.bridge.routes import Route, plan_routes
from safety_island.cli.demo.children import bridge_file
from safety_island.dds.config import URI, DdsConfig
from safety_island.dds.participant import Participant
from safety_island.dds.topics import BRIDGED, CONTROL
from safety_island.errors import ConfigurationError

DEMO = Path(__file__).parents[2] / "demo"
SHIPPED = DEMO / "bridge" / "bridge-config.yaml"
CYCLONE = DEMO / "cyclonedds.xml"
NAMESPACE = "{https://cdds.io/config}"

Plain = set[tuple[int, str, int, str, str]]


def _routes(path: Path) -> list[Route]:
    return plan_routes([read_bridge_file(str(path))])


def _plain(routes: list[Route]) -> Plain:
    return {(*route.source, *route.target, route.type_name) for route in routes}


def test_the_shipped_file_is_the_table_of_topics() -> None:
    """Exactly the six topics of the contract, in both directions."""
    table = {
        (topic.bridged[0], topic.name, topic.bridged[1], topic.name, topic.type_name)
        for topic in BRIDGED
        if topic.bridged is not None
    }
    routes = _routes(SHIPPED)
    assert _plain(routes) == table
    assert len(routes) == 6
    assert sum(route.source[0] == 1 for route in routes) == 5


def test_the_shipped_file_states_the_qos_of_the_table() -> None:
    table = {topic.name: topic.qos for topic in BRIDGED}
    for route in _routes(SHIPPED):
        qos = table[route.source[1]]
        assert (route.qos.reliability, route.qos.durability) == (qos.reliability, qos.durability)
        assert route.qos.depth == (1 if qos.durability == "transient_local" else None)
        assert route.mode == "normal"


def test_the_shipped_file_keeps_to_one_publisher_of_the_command() -> None:
    seconds = {route.source[1]: route.keep.second for route in _routes(SHIPPED)}
    assert seconds.pop(CONTROL.name) == "keep_first"
    assert set(seconds.values()) == {"forward"}


def test_the_demo_bridges_as_the_shipped_file_does(tmp_path: Path) -> None:
    demo = tmp_path / "demo.yaml"
    demo.write_text(bridge_file((1, 2)))

    def facts(path: Path) -> list[tuple[object, ...]]:
        found = [(r.source, r.target, r.type_name, r.qos, r.keep) for r in _routes(path)]
        return sorted(found, key=str)

    assert facts(demo) == facts(SHIPPED)


def _setting(domain: str, *names: str) -> list[str | None]:
    root = ElementTree.parse(CYCLONE).getroot()
    path = "/".join(NAMESPACE + name for name in names)
    found = root.findall(f"{NAMESPACE}Domain[@Id='{domain}']/{path}")
    return [element.text for element in found]


def test_cyclone_settings_are_those_of_the_contract() -> None:
    assert _setting("any", "General", "AllowMulticast") == ["spdp"]
    assert _setting("any", "General", "MaxMessageSize") == ["1400B"]
    assert _setting("any", "Discovery", "LeaseDuration") == ["1s"]
    root = ElementTree.parse(CYCLONE).getroot()
    pinned = {
        domain.get("Id"): interface.get("name")
        for domain in root
        for interface in domain.iter(f"{NAMESPACE}NetworkInterface")
    }
    assert pinned == {"2": "tap0"}


def test_a_machine_without_tap0_gets_a_clear_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(URI, f"file://{CYCLONE}")
    with pytest.raises(ConfigurationError, match="tap0"):
        Participant(2)


def test_other_domains_of_the_file_work(monkeypatch: pytest.MonkeyPatch, domain_id: int) -> None:
    monkeypatch.setenv(URI, f"file://{CYCLONE}")
    Participant(domain_id, DdsConfig()).close()
