# SPDX-License-Identifier: Apache-2.0
"""What the tests of the network do inside a network namespace of their own."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from ipaddress import IPv4Address, IPv4Interface
from pathlib import Path

import pytest

from safety_island.cli.main import main
from safety_island.platform import Network, NetworkError, load
from tests.platform.posix.namespace import ip

NEAR, FAR = "near0", "far0"
"""Two ends of a cable; the far one is in another namespace, with the DHCP server."""
SERVER = "10.9.0.1"
ADDRESS = IPv4Interface("10.9.0.7/24")
PATH = f"{os.environ.get('PATH', '')}:/usr/sbin:/sbin"

_SERVE = f"""
echo ready; read go
ip link set lo up; ip address add {SERVER}/24 dev {FAR}; ip link set {FAR} up
exec dnsmasq --no-daemon --conf-file=/dev/null --port=0 --interface={FAR} --bind-dynamic \\
    --dhcp-authoritative --dhcp-range=10.9.0.50,10.9.0.60,255.255.255.0,2m --no-ping \\
    --dhcp-leasefile="$1/leases" --pid-file= --log-facility=-
"""
_CLIENT = """#!/bin/sh
[ "$1" = bound ] || exit 0
ip address add "$ip/24" dev "$interface"
"""


@contextmanager
def far_end(folder: Path) -> Iterator[None]:
    """Lay the cable and serve addresses at its far end."""
    ip("link", "add", NEAR, "type", "veth", "peer", "name", FAR)
    command = ["unshare", "--net", "sh", "-ec", _SERVE, "serve", str(folder)]
    process = subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env={**os.environ, "PATH": PATH},
    )
    assert process.stdin is not None and process.stdout is not None
    with process:
        try:
            assert process.stdout.readline() == "ready\n"
            ip("link", "set", FAR, "netns", str(process.pid))
            process.stdin.write("go\n")
            process.stdin.flush()
            said = ""
            while "DHCP, IP range" not in said:
                line = process.stdout.readline()
                assert line, said
                said += line
            yield
        finally:
            process.terminate()


@contextmanager
def client(folder: Path) -> Iterator[None]:
    """Ask for an address at the near end, as a machine's own network service would."""
    script = folder / "bound"
    script.write_text(_CLIENT)
    script.chmod(0o755)
    command = ["udhcpc", "-f", "-t", "50", "-T", "1", "-i", NEAR, "-s", str(script)]
    environment = {**os.environ, "PATH": PATH}
    with subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment
    ) as process:
        try:
            yield
        finally:
            process.terminate()


def cable() -> Network:
    """A cable with both ends here, nobody serving."""
    ip("link", "add", NEAR, "type", "veth", "peer", "name", FAR)
    return load("posix").network


def dhcp(folder: str) -> None:
    """The wait ends with the lease, long before its limit."""
    network = load("posix").network
    with far_end(Path(folder)):
        ip("link", "set", NEAR, "up")
        assert network.address(NEAR) is None
        with client(Path(folder)):
            address = network.wait_for_address(NEAR, limit_s=60.0)
    assert address is not None
    assert IPv4Address("10.9.0.50") <= IPv4Address(address) <= IPv4Address("10.9.0.60")
    assert network.describe(NEAR).endswith(address)


def island_after_dhcp(folder: str) -> None:
    """The island starts while the address is on its way, and goes on when it is there."""
    command = [sys.executable, "-m", "safety_island", "run", "--duration", "0.3"]
    command += ["--interface", NEAR, "-D", "NET_DHCPV4_INITIAL_DELAY_MAX=60"]
    with far_end(Path(folder)):
        ip("link", "set", NEAR, "up")
        with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as island:
            assert island.stderr is not None
            line = next(line for line in island.stderr if "waiting at most 60 s" in line)
            assert f"interface '{NEAR}' (it is up and has no IPv4 address)" in line
            with client(Path(folder)):
                said = island.stderr.read()
    assert island.returncode == 0, said
    assert f"interface '{NEAR}' has the IPv4 address 10.9.0." in said
    assert "safety_island is live" in said


def late_interface() -> None:
    """An interface named by hand may come after the start: named at once, then waited for."""
    command = [sys.executable, "-m", "safety_island", "run", "--duration", "0.3"]
    command += ["--interface", NEAR, "-D", "NET_DHCPV4_INITIAL_DELAY_MAX=60"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as island:
        assert island.stderr is not None
        line = next(line for line in island.stderr if "waiting at most 60 s" in line)
        assert f"interface '{NEAR}' (there is no such interface; this machine has lo" in line
        network = cable()
        ip("address", "add", f"{ADDRESS}", "dev", NEAR)
        with pytest.raises(NetworkError, match="it is down"):
            network.wait_for_address(NEAR, limit_s=0.0)
        for end in (FAR, NEAR):
            ip("link", "set", end, "up")
        said = island.stderr.read()
    assert island.returncode == 0, said
    assert f"interface '{NEAR}' has the IPv4 address {ADDRESS.ip}" in said
    assert "safety_island is live" in said


def no_dhcp() -> None:
    """Nobody answers: the wait ends at its limit, with what was seen."""
    network = cable()
    with pytest.raises(NetworkError, match=f"'{NEAR}' has no IPv4 address after 0.2 s .it is down"):
        network.wait_for_address(NEAR, limit_s=0.2)
    ip("link", "set", NEAR, "up")
    with pytest.raises(NetworkError, match="it is up, its link is down, and has no IPv4"):
        network.wait_for_address(NEAR, limit_s=0.2)
    ip("link", "set", FAR, "up")
    with pytest.raises(NetworkError, match="it is up and has no IPv4 address"):
        network.wait_for_address(NEAR, limit_s=1.0)


def static_address() -> None:
    """Address and gateway are set once; what is there is left alone."""
    network = cable()
    with pytest.raises(NetworkError, match=r"cannot get the gateway 192.0.2.1: Network is unreach"):
        network.configure(NEAR, 0, ADDRESS, IPv4Address("192.0.2.1"))
    for _ in range(2):
        assert network.configure(NEAR, 0, ADDRESS, IPv4Address(SERVER)) == NEAR
    assert network.wait_for_address(NEAR, limit_s=0.0) == "10.9.0.7"
    assert ip("address", "show", NEAR).count("inet 10.9.0.7/24") == 1
    ip("link", "set", FAR, "up")
    assert ip("route", "show", "default").split()[:5] == ["default", "via", SERVER, "dev", NEAR]
    with pytest.raises(NetworkError, match=rf"has a default route already, over {SERVER}"):
        network.configure(NEAR, 0, ADDRESS, IPv4Address("10.9.0.2"))
    with pytest.raises(NetworkError, match="'nosuch0': there is no such interface"):
        network.configure("nosuch0", 0, ADDRESS, None)


def vlan() -> None:
    """The address is on the VLAN, which is made once; another's name is not taken over."""
    network = cable()
    for _ in range(2):
        assert network.configure(NEAR, 12, ADDRESS, None) == f"{NEAR}.12"
    assert network.address(f"{NEAR}.12") == "10.9.0.7"
    assert network.address(NEAR) is None
    assert "vlan protocol 802.1Q id 12 " in ip("-details", "link", "show", f"{NEAR}.12")
    ip("link", "add", f"{NEAR}.13", "type", "veth", "peer", "name", "elevenchars")
    with pytest.raises(NetworkError, match=f"'{NEAR}.13' is there and is not VLAN 13"):
        network.configure(NEAR, 13, None, None)
    with pytest.raises(NetworkError, match="at most 15 characters"):
        network.configure("elevenchars", 1234, None, None)


def island_on_vlan() -> None:
    """The configuration's static address and VLAN carry DDS."""
    cable()
    words = ["DDS_NETWORK_INTERFACE=near0", "NET_IFACE1_ADDR=10.9.0.7", "NET_IFACE1_VLAN=12"]
    options = [part for word in words for part in ("-D", word)]
    command = [sys.executable, "-m", "safety_island", "run", "--duration", "0.3", *options]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert f"interface '{NEAR}.12' has the IPv4 address 10.9.0.7" in done.stderr
    assert "safety_island is live" in done.stderr


def not_permitted() -> None:
    """Without the right to configure, one line says so; what is there already needs none."""
    cable()
    ip("address", "add", str(ADDRESS), "dev", NEAR)
    ip("link", "set", NEAR, "up")
    code = "from tests.platform.posix.scenes import unprivileged; unprivileged()"
    nested = ["setpriv", "--bounding-set=-all", "--inh-caps=-all", sys.executable, "-c", code]
    done = subprocess.run(nested, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("island: error: ") == 1


def unprivileged() -> None:
    """What a process without CAP_NET_ADMIN meets."""
    network = load("posix").network
    assert network.configure(NEAR, 0, ADDRESS, None) == NEAR
    with pytest.raises(NetworkError, match="needs the right CAP_NET_ADMIN"):
        network.configure(NEAR, 0, IPv4Interface("10.9.0.8/24"), None)
    assert main(["run", "--interface", NEAR, "-D", "NET_IFACE1_ADDR=10.9.0.8"]) == 1
