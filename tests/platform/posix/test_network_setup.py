# SPDX-License-Identifier: Apache-2.0
"""Addresses from a real DHCP server, from none, static ones and VLANs, in network namespaces."""

from __future__ import annotations

import errno
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest
from pyroute2.netlink.exceptions import NetlinkError

from safety_island.platform import NetworkError
from safety_island.platform.posix.network_setup import configure
from tests.platform.posix.namespace import ISOLATED, call_isolated, may_isolate
from tests.platform.posix.scenes import PATH

SCENES = "tests.platform.posix.scenes"
isolated = pytest.mark.skipif(not may_isolate(), reason="no network namespaces on this machine")
needs_dhcp = pytest.mark.skipif(
    not all(shutil.which(name, path=PATH) for name in ("dnsmasq", "udhcpc")),
    reason="dnsmasq or udhcpc is not installed",
)


@isolated
@needs_dhcp
@pytest.mark.parametrize("scene", ["dhcp", "island_after_dhcp"])
def test_with_a_dhcp_server(scene: str, tmp_path: Path) -> None:
    call_isolated(SCENES, scene, str(tmp_path))


@isolated
@pytest.mark.parametrize("scene", ["no_dhcp", "late_interface", "static_address", "not_permitted"])
def test_without_one(scene: str) -> None:
    call_isolated(SCENES, scene)


def has_vlans() -> bool:
    """Whether the kernel knows VLANs."""
    make = "ip link add a0 type veth peer name b0; ip link add link a0 name a0.2 type vlan id 2"
    return subprocess.run([*ISOLATED, "sh", "-ec", make], capture_output=True).returncode == 0


@isolated
@pytest.mark.parametrize("scene", ["vlan", "island_on_vlan"])
def test_vlan(scene: str) -> None:
    if not has_vlans():
        pytest.skip("the kernel of this machine has no VLANs")
    call_isolated(SCENES, scene)


class Link(dict[str, Any]):
    """An interface as pyroute2 describes it."""

    def get_attr(self, name: str) -> object:
        return self[name]

    def get_nested(self, *names: str) -> object:
        return self.get("vlan")


class Kernel:
    """Interfaces in place of the kernel's, so that VLANs can be tested without them."""

    def __init__(self) -> None:
        self.links = {"eth0": Link(index=1, flags=0, IFLA_LINK=None)}

    def __call__(self) -> Kernel:
        return self

    def __enter__(self) -> Kernel:
        return self

    def __exit__(self, *_: object) -> None: ...

    def link_lookup(self, ifname: str) -> list[int]:
        return [self.links[ifname]["index"]] if ifname in self.links else []

    def get_links(self, index: int) -> list[Link]:
        return [link for link in self.links.values() if link["index"] == index]

    def link(self, action: str, **values: Any) -> None:
        if action == "add":
            assert values["kind"] == "vlan"
            made = Link(index=len(self.links) + 1, flags=0, vlan=values["vlan_id"])
            self.links[values["ifname"]] = Link(made, IFLA_LINK=values["link"])
        else:
            (link,) = self.get_links(values["index"])
            link["flags"] |= values["state"] == "up"


def test_vlan_is_made_once_and_brought_up(monkeypatch: pytest.MonkeyPatch) -> None:
    kernel = Kernel()
    monkeypatch.setattr("pyroute2.IPRoute", kernel)
    for _ in range(2):
        assert configure("eth0", 12, None, None) == "eth0.12"
    assert kernel.links["eth0.12"] == Link(index=2, flags=1, vlan=12, IFLA_LINK=1)
    assert len(kernel.links) == 2
    assert kernel.links["eth0"]["flags"] == 1


def test_vlan_whose_name_another_has(monkeypatch: pytest.MonkeyPatch) -> None:
    kernel = Kernel()
    kernel.links["eth0.12"] = Link(index=2, flags=1, vlan=13, IFLA_LINK=1)
    kernel.links["eth0.14"] = Link(index=3, flags=1, vlan=14, IFLA_LINK=2)
    kernel.links["elevenchars"] = Link(index=4, flags=1)
    monkeypatch.setattr("pyroute2.IPRoute", kernel)
    with pytest.raises(NetworkError, match=r"'eth0.12' is there and is not VLAN 12: remove it"):
        configure("eth0", 12, None, None)
    with pytest.raises(NetworkError, match=r"'eth0.14' is there and is not VLAN 14"):
        configure("eth0", 14, None, None)
    with pytest.raises(NetworkError, match=r"'elevenchars\.1234': a name has at most 15"):
        configure("elevenchars", 1234, None, None)


def test_kernel_without_vlans(monkeypatch: pytest.MonkeyPatch) -> None:
    kernel = Kernel()

    def refuse(*_: object, **__: object) -> None:
        raise NetlinkError(errno.EOPNOTSUPP, "Operation not supported")

    kernel.links["eth0"]["flags"] = 1
    monkeypatch.setattr(kernel, "link", refuse)
    monkeypatch.setattr("pyroute2.IPRoute", kernel)
    with pytest.raises(NetworkError, match=r"'eth0' cannot get VLAN 5: the kernel .* 8021q"):
        configure("eth0", 5, None, None)
