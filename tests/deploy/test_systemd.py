# SPDX-License-Identifier: Apache-2.0
"""The shipped systemd units: accepted by systemd itself, and in keeping with the program."""

from __future__ import annotations

import configparser
import shutil
import subprocess
from pathlib import Path

import pytest

from safety_island.cli.bridge import configure as configure_bridge
from safety_island.cli.parser import Parser
from safety_island.cli.run import configure as configure_run
from safety_island.platform.posix import real_time

ROOT = Path(__file__).parents[2]
UNITS = sorted((ROOT / "deploy" / "systemd").glob("*.service"))
INSTALLED = "/opt/safety-island"
PRIORITIES = {"safety-island": real_time.ISLAND, "safety-island-bridge": real_time.BRIDGE}
CONFIGURE = {"run": configure_run, "bridge": configure_bridge}


class Unit:
    """What a unit says; a key that comes more than once keeps every value."""

    def __init__(self, path: Path) -> None:
        self.lines = path.read_text("utf-8").splitlines()

    def all(self, key: str) -> list[str]:
        return [line.partition("=")[2] for line in self.lines if line.startswith(f"{key}=")]

    def __getitem__(self, key: str) -> str:
        (value,) = self.all(key)
        return value


@pytest.fixture(params=UNITS, ids=lambda path: path.stem)
def path(request: pytest.FixtureRequest) -> Path:
    found: Path = request.param
    return found


def test_island_and_bridge_have_a_unit_each() -> None:
    assert {unit.stem for unit in UNITS} == set(PRIORITIES)


@pytest.mark.skipif(
    shutil.which("systemd-analyze") is None, reason="systemd-analyze is not installed"
)
def test_systemd_accepts_the_unit(path: Path, tmp_path: Path) -> None:
    """With this folder in place of the one that it is installed to."""
    copy = tmp_path / path.name
    copy.write_text(path.read_text("utf-8").replace(INSTALLED, str(ROOT)), "utf-8")
    result = subprocess.run(
        ["systemd-analyze", "verify", "--man=no", "--recursive-errors=yes", copy],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    ours = [line for line in result.stderr.splitlines() if path.name in line]
    assert (result.returncode, ours) == (0, [])


def test_its_limits_allow_what_the_program_takes(path: Path) -> None:
    unit = Unit(path)
    assert int(unit["LimitRTPRIO"]) == PRIORITIES[path.stem].control
    assert unit["LimitMEMLOCK"] == "infinity"
    assert "RestrictRealtime=yes" not in unit.lines
    assert unit.all("LimitAS") == [], "most of the address space is reserved and never used"


def test_it_is_watched_and_started_again_without_end(path: Path) -> None:
    unit = Unit(path)
    assert (unit["Type"], unit["NotifyAccess"], unit["Restart"]) == ("notify", "main", "always")
    assert float(unit["WatchdogSec"]) >= 2 * 1.0, "the longest period is a second"
    assert unit["StartLimitIntervalSec"] == "0"


def test_its_commands_exist(path: Path) -> None:
    unit = Unit(path)
    (name,) = unit.all("ExecStart")
    program, command, *options = name.split()
    assert program == f"{INSTALLED}/.venv/bin/island"
    parser = Parser(prog=command)
    CONFIGURE[command](parser)
    given = [text.strip('"').partition("=") for text in unit.all("Environment")]
    values = {name: value.split() for name, _, value in given}
    words = [word for option in options for word in values.get(option[1:], [])]
    parser.parse([word.replace(INSTALLED, str(ROOT)) for word in words])
    for word in words:
        assert not word.startswith(INSTALLED) or Path(word.replace(INSTALLED, str(ROOT))).exists()


def test_it_is_well_formed(path: Path) -> None:
    parser = configparser.RawConfigParser(strict=False, interpolation=None)
    parser.read(path, "utf-8")
    assert parser.sections() == ["Unit", "Service", "Install"]
