# SPDX-License-Identifier: Apache-2.0
"""Programs of others, set up as their own pages say, find an island on loopback.

Two of CycloneDDS: its newest release, and 0.10 of Debian and of ROS 2 up to Jazzy.
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from safety_island.cli.env import configure, variables
from safety_island.cli.parser import Parser
from tests.interop.namespace import Namespace, Running
from tests.network.conftest import Machine
from tests.network.peer import ECHO

DOMAIN = "2"
TOPIC = f"rt{ECHO}"
Peer = Callable[[Namespace, dict[str, str]], Running]


def configured(general: str, more: str = "") -> dict[str, str]:
    domain = f"<General>{general}</General>{more}"
    return {
        "CYCLONEDDS_URI": f'<CycloneDDS><Domain Id="any">{domain}</Domain></CycloneDDS>',
    }


LO = "<Interfaces><NetworkInterface {}/></Interfaces>"
SETUPS = {
    "lo": configured(LO.format('name="lo"')),
    "lo with multicast": configured(LO.format('name="lo" multicast="true"')),
    "Autoware's file": configured(
        LO.format('autodetermine="false" name="lo" priority="default" multicast="default"')
        + "<AllowMulticast>default</AllowMulticast><MaxMessageSize>65500B</MaxMessageSize>",
        '<Internal><SocketReceiveBufferSize min="10kB"/>'
        "<Watermarks><WhcHigh>500kB</WhcHigh></Watermarks></Internal>",
    ),
}


@pytest.fixture(scope="module")
def old_program(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Compile the program with CycloneDDS 0.10."""
    if not Path("/usr/include/dds/dds.h").exists() or shutil.which("cc") is None:
        pytest.skip("no CycloneDDS in C on this machine (Debian: cyclonedds-dev)")
    program = tmp_path_factory.mktemp("old") / "old_peer"
    source = Path(__file__).with_name("old_peer.c")
    subprocess.run(["cc", "-o", str(program), str(source), "-lddsc"], check=True)
    return str(program)


@pytest.fixture(params=["newest", "0.10"])
def peer(request: pytest.FixtureRequest) -> Peer:
    """Start a peer on a machine; it prints how many publishers of the topic it sees."""
    if request.param == "newest":
        return lambda machine, environment: machine.island(
            "tests.network.new_peer", DOMAIN, TOPIC, environment=environment
        )
    program = request.getfixturevalue("old_program")
    return lambda machine, environment: machine.start([program, DOMAIN, TOPIC], environment)


def island(machine: Namespace, *more: str) -> Running:
    running = machine.island("tests.network.peer", "come-and-go", DOMAIN, "lo", *more)
    assert running.expect(str) == "open"
    return running


def sees(peer: Running, count: int) -> bool:
    return bool(peer.expect(lambda line: line == str(count)))


def environment(*options: str) -> dict[str, str]:
    """Return what ``island env`` prints."""
    parser = Parser(prog="island env")
    configure(parser)
    return dict(variables(parser.parse(["--for", "cyclonedds", *options])))


@pytest.fixture
def laptop(machine: Machine) -> Namespace:
    """A machine with a network beside its loopback."""
    made, other = machine(), machine()
    made.link("eth0", "192.168.77.2", other, "192.168.77.3")
    return made


@pytest.mark.parametrize("setup", SETUPS)
def test_a_peer_on_loopback_finds_the_island(laptop: Namespace, peer: Peer, setup: str) -> None:
    island(laptop)
    assert sees(peer(laptop, SETUPS[setup]), 1)


def test_a_peer_without_settings_finds_the_island_where_there_is_loopback_only(
    machine: Machine, peer: Peer
) -> None:
    alone = machine()
    island(alone)
    assert sees(peer(alone, {}), 1)


@pytest.mark.parametrize("tag", ["", "vehicle-7"])
def test_a_peer_finds_the_island_with_what_island_env_prints(
    laptop: Namespace, peer: Peer, tag: str
) -> None:
    island(laptop, tag)
    assert sees(peer(laptop, environment(*(["--domain-tag", tag] if tag else []))), 1)


def test_a_tag_hides_the_island_from_those_without_it(laptop: Namespace, peer: Peer) -> None:
    """Of two islands the peer sees the one without a tag; when that has left, none."""
    island(laptop, "vehicle-7")
    plain = island(laptop)
    other = peer(laptop, environment())
    assert sees(other, 1)
    plain.tell("close")
    assert other.expect(str) == "0"


def test_a_peer_sees_that_a_publisher_is_closed_while_its_node_lives(
    laptop: Namespace, peer: Peer
) -> None:
    running = island(laptop)
    other = peer(laptop, environment())
    assert sees(other, 1)
    running.tell("close")
    assert sees(other, 0)
