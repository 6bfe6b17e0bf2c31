# SPDX-License-Identifier: Apache-2.0
"""The self-contained program: it starts on bare Python, needs no compiler, and is reproducible."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from safety_island import __version__
from safety_island.kernel import kernel
from safety_island.targets.package.built import built
from tests.targets.package import pyz_process

NAME = "safety-island.pyz"
pytestmark = pytest.mark.timeout(600)  # the first of a session compiles the kernels


@pytest.fixture(scope="session")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A home folder, in which the island is unpacked once."""
    return tmp_path_factory.mktemp("home")


@pytest.fixture(scope="session")
def island(posix_build: Path) -> Path:
    """The program."""
    return posix_build / NAME


PROBE = """
import json, sys
sys.argv = ["island", "run", "--platform", "sim", "--duration", "2"]
from safety_island.__main__ import start
code = start()
found = sorted({name.partition(".")[0] for name in sys.modules})
import numpy, safety_island
from safety_island.dds.library.loading import loaded
print(json.dumps([code, found, numpy.__file__, safety_island.__file__, str(loaded().path)]))
"""


def test_it_runs_on_bare_python_and_imports_no_compiler(island: Path, home: Path) -> None:
    first = pyz_process.run(island, home, "--version")
    assert (first.returncode, first.stdout) == (0, f"island {__version__}\n")
    assert "unpacking" in first.stderr
    (folder,) = (home / "cache").glob("island-*")
    result = subprocess.run(
        [pyz_process.bare_python(), "-s", "-c", PROBE],
        env=pyz_process.environment(home) | {"PYTHONPATH": str(folder)},
        cwd=home,
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 0, result.stderr[-2000:]
    code, modules, *files = json.loads(result.stdout.splitlines()[-1])
    assert code == 0
    assert "numpy" in modules
    assert not {"numba", "llvmlite", "scipy", "cyclonedds"} & set(modules)
    assert len(files) == 3 and all(Path(file).is_relative_to(folder) for file in files)


def test_a_second_start_unpacks_nothing_and_gives_commands(island: Path, home: Path) -> None:
    pyz_process.run(island, home, "--version")
    arguments = ("run", "--platform", "sim", "--duration", "5", "--json")
    result = pyz_process.run(island, home, *arguments)
    assert result.returncode == 0, result.stderr[-2000:]
    assert "unpacking" not in result.stderr
    assert "compil" not in result.stderr
    summary = json.loads(result.stdout.splitlines()[-1])
    events = [json.loads(line) for line in result.stdout.splitlines()]
    assert any(event["event"] == "tick" and event["outcome"] == "PUBLISHED" for event in events)
    assert summary["event"]


CPU_TIME = """
import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True, capture_output=True)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime)
"""


def processor_time(command: list[str], environment: dict[str, str], folder: Path) -> float:
    """Return the least processor time [s] of a few runs; the first one fills the caches."""
    watched = [sys.executable, "-c", CPU_TIME, *command]
    runs = [subprocess.check_output(watched, env=environment, cwd=folder) for _ in range(4)]
    return min(map(float, runs[1:]))


@pytest.mark.skipif(not kernel.JIT, reason="compares with kernels that are compiled in process")
def test_a_start_is_quicker_than_one_that_loads_a_compiler(island: Path, home: Path) -> None:
    words = ("run", "--platform", "sim", "--duration", "0.3")
    built_one = pyz_process.command(island, *words)
    from_sources = [sys.executable, "-m", "safety_island", *words]
    quick = processor_time(built_one, pyz_process.environment(home), home)
    assert quick < 0.8 * processor_time(from_sources, dict(os.environ), home)


def test_its_configuration_is_that_of_the_build(island: Path, home: Path) -> None:
    for option in (("-t", "freertos_posix"), ("-D", "LOG_LEVEL=2"), ("--conf", "my.conf")):
        result = pyz_process.run(island, home, "run", *option)
        assert result.returncode == 2
        assert f"{' '.join(option)}: this island was built for posix" in result.stderr
    for command in (("build",), ("config", "show"), ("menuconfig",)):
        result = pyz_process.run(island, home, *command, "-t", "posix")
        assert result.returncode == 2
        assert "carries no build tools" in result.stderr
    assert built() is None


def test_it_holds_no_path_of_this_machine_and_no_time(island: Path) -> None:
    with zipfile.ZipFile(island) as archive:
        assert {item.date_time for item in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        names = archive.namelist()
        root = str(Path(__file__).parents[3]).encode()
        for name in names:
            if "/safety_island/" in name:
                assert root not in archive.read(name), name
    assert not [
        name
        for name in names
        if re.search(r"^content/(numba|llvmlite)|\.pyc$|direct_url\.json", name)
    ]
    assert any("LICENSE" in name for name in names)
