# SPDX-License-Identifier: Apache-2.0
"""``island env`` prints what a shell can evaluate."""

from __future__ import annotations

import subprocess
import xml.etree.ElementTree as ElementTree

import pytest

from safety_island.cli.main import main
from safety_island.dds.config import URI


def printed(capsys: pytest.CaptureFixture[str], *options: str) -> dict[str, str]:
    """Return the variables that a shell has after it evaluated the output."""
    assert main(["env", *options]) == 0
    lines = capsys.readouterr().out
    shell = subprocess.run(
        ["sh", "-c", f"{lines}\nenv -0"], capture_output=True, text=True, check=True, env={}
    )
    pairs = (entry.partition("=") for entry in shell.stdout.split("\0") if entry)
    return {name: value for name, _, value in pairs if name not in ("PWD", "_", "SHLVL", "OLDPWD")}


def test_ros_gets_the_domain_and_loopback(capsys: pytest.CaptureFixture[str]) -> None:
    found = printed(capsys, "--domain", "7")
    assert found.keys() == {"ROS_DOMAIN_ID", URI} and found["ROS_DOMAIN_ID"] == "7"
    domain = ElementTree.fromstring(found[URI]).find("Domain")
    assert domain is not None
    assert [item.attrib for item in domain.iter("NetworkInterface")] == [{"name": "lo"}]
    assert [item.attrib for item in domain.iter("Peer")] == [{"Address": "127.0.0.1"}]


def test_fast_dds_needs_the_domain_alone(capsys: pytest.CaptureFixture[str]) -> None:
    assert printed(capsys, "--for", "fastdds") == {"ROS_DOMAIN_ID": "2"}


def test_peers_and_a_tag_are_passed_on(capsys: pytest.CaptureFixture[str]) -> None:
    options = ["--interface", "eth0", "--peer", "192.0.2.7", "--domain-tag", "it's 7"]
    found = printed(capsys, *options)
    assert found["ROS_STATIC_PEERS"] == "192.0.2.7"
    assert found["RMW_IMPLEMENTATION"] == "rmw_cyclonedds_cpp"
    assert ElementTree.fromstring(found[URI]).findtext("Domain/Discovery/Tag") == "it's 7"


def test_fast_dds_has_no_tag(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["env", "--for", "fastdds", "--domain-tag", "x"]) == 2
    assert "Fast DDS has none" in capsys.readouterr().err
