# SPDX-License-Identifier: Apache-2.0
"""``build.sh`` and ``island build``: flags, refusals, what is made, what is not made again."""

from __future__ import annotations

import hashlib
import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from safety_island.cli import build as command
from safety_island.cli.main import main
from safety_island.targets.aot import linker
from safety_island.targets.aot.archive import archive
from safety_island.targets.kconfig.places import Places
from safety_island.targets.kconfig.resolve import resolve
from safety_island.targets.kconfig.targets import NAMES
from safety_island.targets.package import pipeline
from safety_island.targets.package.manifest import is_current
from safety_island.targets.package.pipeline import Build
from safety_island.targets.package.products import APPLICATION

ROOT = Path(__file__).parents[3]
pytestmark = pytest.mark.timeout(600)  # the first of a session compiles the kernels


def test_the_shell_front_passes_on_its_arguments() -> None:
    text = (ROOT / "build.sh").read_text()
    assert (ROOT / "build.sh").stat().st_mode & 0o111
    assert '/island" build "$@"' in text
    subprocess.run(["sh", "-n", str(ROOT / "build.sh")], check=True)


@pytest.mark.parametrize("flag", ["-h", "--help"])
def test_help_tells_every_flag_of_the_contract(
    flag: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["build", flag])
    assert ended.value.code == 0
    text = capsys.readouterr().out
    for word in ("-t TARGET", "-c,", "-h,", "--unit-test", "--dds-publisher", "--dds-subscriber"):
        assert word in text


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["-t", "nope"], f"unknown target 'nope', expected one of {', '.join(NAMES)}"),
        (["-t", "posx"], "did you mean 'posix'?"),
        ([], f"-t TARGET is missing, expected one of {', '.join(NAMES)}"),
        (["-t", "posix", "-D", "LOG_LEVEL=9"], "LOG_LEVEL=9"),
        (["-t", "posix", "--unit-test", "--dds-publisher"], "not allowed with"),
        (["-t", "s32z270dc2_rtu0_r52@D", "--dds-subscriber"], "runs no Python"),
    ],
)
def test_what_cannot_be_built_is_one_line(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["build", *arguments]) in (1, 2)
    errors = capsys.readouterr().err.splitlines()
    assert len(errors) == 1
    assert said in errors[0]


@pytest.fixture
def in_tmp(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """``island build`` works in a folder of its own."""
    monkeypatch.setattr(command, "places", lambda: Places(build=tmp_path / "build"))
    return tmp_path


def test_clean_removes_every_build(in_tmp: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("posix", "freertos_posix", "mine"):
        (in_tmp / "build" / name / "objects").mkdir(parents=True)
    assert main(["build", "-c"]) == 0
    assert capsys.readouterr().out == "removed freertos_posix, posix\n"
    assert [path.name for path in (in_tmp / "build").iterdir()] == ["mine"]
    assert main(["build", "--clean"]) == 0
    assert capsys.readouterr().out == "nothing to remove\n"


def test_a_build_shows_its_steps_and_a_second_one_does_nothing(
    posix_build: Path,
    in_tmp: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert posix_build.exists()  # the kernels are compiled
    monkeypatch.setattr(pipeline, "content", lambda *_: {"made.py": b""})
    assert main(["build", "-t", "posix", "-D", "LOG_LEVEL=2"]) == 0
    out = capsys.readouterr().out
    for step in ("configuration", "message types", "control kernels", "shared library", "done"):
        assert step in out
    folder = in_tmp / "build" / "posix"
    times = {path: path.stat().st_mtime_ns for path in folder.rglob("*")}
    assert main(["build", "-t", "posix", "-D", "LOG_LEVEL=2"]) == 0
    assert capsys.readouterr().out.endswith("up to date, nothing to do\n")
    assert {path: path.stat().st_mtime_ns for path in folder.rglob("*")} == times
    assert "CONFIG_LOG_LEVEL=2\n" in (folder / ".config").read_text()
    (folder / "include" / "safety_island_messages.h").write_text("")
    assert main(["build", "-t", "posix", "-D", "LOG_LEVEL=2"]) == 0
    assert "done" in capsys.readouterr().out


def test_a_machine_without_a_c_compiler_is_told_how_to_get_one(
    in_tmp: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(linker, "find_compiler", lambda machine: None)
    assert main(["build", "-t", "posix"]) == 1
    (error,) = capsys.readouterr().err.splitlines()
    assert "no C compiler" in error and "apt-get install gcc" in error and linker.ZIG in error


@pytest.mark.slow
def test_a_build_in_another_place_gives_the_same_bytes(posix_build: Path, tmp_path: Path) -> None:
    places = Places(build=tmp_path / "elsewhere")
    other = Build(resolve("posix", places=places), APPLICATION, places, lambda step: None)
    other.run()
    assert len(other.files) > 8
    for name in (*other.files, "manifest.json"):
        assert (other.folder / name).read_bytes() == (posix_build / name).read_bytes(), name


def test_the_manifest_tells_what_was_made_of_what(posix_build: Path) -> None:
    text = (posix_build / "manifest.json").read_text()
    manifest = json.loads(text)
    for name, told in manifest["artefacts"].items():
        data = (posix_build / name).read_bytes()
        expected = {"size": len(data), "sha256": hashlib.sha256(data).hexdigest()}
        assert told == expected, name
    inputs = manifest["inputs"]
    assert inputs["target"] == "posix"
    assert {"numba", "llvmlite", "numpy"} == set(inputs["compilers"])
    assert "cyclonedds" in inputs["packages"]
    assert set(inputs["revision"]) == {"commit", "modified"}
    assert len(inputs["kernel_sources"]) == 64
    assert manifest["records"]["safety_island_point"] == 88
    assert str(ROOT) not in text
    assert is_current(posix_build / "manifest.json", inputs)
    assert not is_current(posix_build / "manifest.json", inputs | {"version": "0"})
    assert not is_current(posix_build / "missing.json", inputs)


def test_every_target_is_built(build_of: Callable[[str], Path]) -> None:
    for target in NAMES:
        made = json.loads((build_of(target) / "manifest.json").read_text())["artefacts"]
        assert ".config" in made
        assert ("safety-island.pyz" in made) == ("posix" in target)
        assert ("libsafety_island_control.a" in made) == ("posix" not in target)


def test_a_library_of_odd_sizes_is_padded() -> None:
    data = archive(
        {"a.o": b"abc", "a_very_long_name.o": b"defg"}, {"a.o": ["f"], "a_very_long_name.o": []}
    )
    assert len(data) % 2 == 0
    assert data[8:24] == b"/" + b" " * 15
    assert b"abc\n/5 " in data


def test_sizes_are_told_below_the_current_folder(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    assert command._shown(tmp_path / "build" / "x") == "build/x"
    assert command._shown(Path("/elsewhere/x")) == "/elsewhere/x"
