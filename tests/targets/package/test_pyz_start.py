# SPDX-License-Identifier: Apache-2.0
"""The start of a self-contained program: what it unpacks, when, and what it refuses."""

from __future__ import annotations

import os
import subprocess
import zipfile
from pathlib import Path

import pytest

from safety_island.targets.package import pyz_start
from safety_island.targets.package.pyz import write_pyz
from tests.targets.package import pyz_process

CONTENT = {"hello/__init__.py": b"def main():\n    print('hello')\n    return 3\n"}


@pytest.fixture
def hello(tmp_path: Path) -> Path:
    """A small program."""
    path = tmp_path / "hello.pyz"
    write_pyz(path, CONTENT, "hello:main")
    return path


def test_the_same_content_gives_the_same_bytes(hello: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.pyz"
    write_pyz(other, dict(reversed(CONTENT.items())), "hello:main")
    assert other.read_bytes() == hello.read_bytes()
    assert hello.stat().st_mode & 0o111


def test_two_processes_may_unpack_at_the_same_time(hello: Path, tmp_path: Path) -> None:
    commands = [pyz_process.command(hello)] * 4
    environment = pyz_process.environment(tmp_path)
    processes = [subprocess.Popen(command, env=environment) for command in commands]
    assert [process.wait() for process in processes] == [3, 3, 3, 3]
    assert len(list((tmp_path / "cache").iterdir())) == 1


def test_a_folder_that_is_not_complete_is_replaced(hello: Path, tmp_path: Path) -> None:
    assert pyz_process.run(hello, tmp_path).returncode == 3
    (folder,) = (tmp_path / "cache").iterdir()
    (folder / pyz_start.COMPLETE).unlink()
    (folder / "hello" / "__init__.py").write_text("broken(")
    result = pyz_process.run(hello, tmp_path)
    assert (result.returncode, result.stdout) == (3, "hello\n")


@pytest.mark.parametrize(
    ("there", "here", "said"),
    [
        (b'python="3.', b'python="2.', "was built for Python 2."),
        (b'machine="', b'machine="not-', "was built for not-"),
    ],
)
def test_another_python_or_machine_is_told(
    tmp_path: Path, there: bytes, here: bytes, said: str
) -> None:
    path = tmp_path / "hello.pyz"
    write_pyz(path, CONTENT, "hello:main")
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    members["__main__.py"] = members["__main__.py"].replace(there, here)
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in members.items():
            archive.writestr(name, data)
    result = pyz_process.run(path, tmp_path)
    assert result.returncode == 2
    assert result.stderr.startswith("island: error: hello.pyz ") and said in result.stderr
    assert len(result.stderr.splitlines()) == 1


def test_a_place_that_cannot_be_written_is_told(hello: Path, tmp_path: Path) -> None:
    (tmp_path / "cache").write_text("a file")
    result = pyz_process.run(hello, tmp_path)
    assert result.returncode == 2
    assert "is not a folder but a file; name a folder of your own" in result.stderr
    assert result.stderr.count("\n") == 1


def test_a_folder_that_others_can_write_to_is_not_run(hello: Path, tmp_path: Path) -> None:
    """Whoever wrote into it would run code as this user."""
    assert pyz_process.run(hello, tmp_path).returncode == 3
    (folder,) = (tmp_path / "cache").iterdir()
    folder.chmod(0o777)
    result = pyz_process.run(hello, tmp_path)
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr.startswith(f"island: error: {folder} can be written by others (mode 777);")
    assert result.stderr.count("\n") == 1


@pytest.mark.skipif(os.geteuid() != 0, reason="gives files away, as only root may")
@pytest.mark.parametrize("below", ["", "hello"])
def test_a_folder_of_another_user_is_not_run(hello: Path, tmp_path: Path, below: str) -> None:
    assert pyz_process.run(hello, tmp_path).returncode == 3
    (folder,) = (tmp_path / "cache").iterdir()
    os.chown(folder / below, 4242, 4242)
    result = pyz_process.run(hello, tmp_path)
    assert (result.returncode, result.stdout) == (2, "")
    assert "belongs to user 4242, not to 0; name a folder of your own" in result.stderr


def test_a_link_in_place_of_the_folder_is_not_followed(hello: Path, tmp_path: Path) -> None:
    assert pyz_process.run(hello, tmp_path).returncode == 3
    (folder,) = (tmp_path / "cache").iterdir()
    folder.rename(tmp_path / "elsewhere")
    folder.symlink_to(tmp_path / "elsewhere")
    result = pyz_process.run(hello, tmp_path)
    assert (result.returncode, result.stdout) == (2, "")
    assert "is not a folder but a link" in result.stderr
