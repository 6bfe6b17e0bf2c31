# SPDX-License-Identifier: Apache-2.0
"""docs/autoware.md as written: the DDS file for two machines, the bridge file of newer names."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

import pytest
import yaml

from safety_island.cli.bridge import SHIPPED
from safety_island.dds.topics import TRAJECTORY
from tests.network.conftest import Machine

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "autoware.md").read_text("utf-8")


@pytest.mark.live
def test_the_file_for_two_machines_lets_the_island_drive(machine: Machine, tmp_path: Path) -> None:
    (xml,) = re.findall(r"^```xml\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    file = tmp_path / "two-machines.xml"
    file.write_text(xml, "utf-8")
    autoware, island = machine(), machine()
    autoware.link("eth0", "10.11.0.1", island, "10.11.0.2")
    autoware.run("ip", "link", "set", "lo", "multicast", "on")
    run = island.island(
        "safety_island", "run", "--interface", "eth0", "--json", "--duration", "120"
    )
    bridge = {"CYCLONEDDS_URI": f"file://{file}"}
    autoware.island("safety_island", "bridge", "--duration", "120", environment=bridge)
    autoware.island("safety_island", "main-compute", "--repeat", "--duration", "120")

    def drives(line: str) -> bool:
        tick = json.loads(line)
        return bool(tick.get("state") == "ACTIVE" and tick.get("acceleration", 0.0) > 0.0)

    assert run.expect(drives, timeout_s=90.0)


def test_the_bridge_file_for_newer_names() -> None:
    (command,) = re.findall(r"^(sed .*?bridge-config\.yaml) >", PAGE, re.MULTILINE | re.DOTALL)
    made = subprocess.run(
        ["sh", "-c", command], cwd=ROOT, capture_output=True, text=True, check=True
    )
    changed, shipped = yaml.safe_load(made.stdout), yaml.safe_load(SHIPPED.read_text("utf-8"))
    newer = {name for _, name, _ in TRAJECTORY.newer}
    assert set(changed["topics"]) ^ set(shipped["topics"]) == {TRAJECTORY.name, *newer}
