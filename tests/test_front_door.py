# SPDX-License-Identifier: Apache-2.0
"""The script ``./island``: makes .venv once, repairs it when needed, says what is missing.

A stand-in for uv makes the environment here, so no test needs the network.
"""

from __future__ import annotations

import os
import re
import shutil
import stat
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
TOOLS = (
    "sh", "dirname", "readlink", "cat", "cksum", "rm", "mkdir", "ln", "flock", "expr", "chmod",
    "awk", "date", "df", "du", "find", "grep", "sed", "tail", "wc",
)  # fmt: skip

UV = """#!/bin/sh
echo "uv $*" >>"$UV_LOG"
case $* in
    *--dry-run*) [ ! -e "$UV_LOG.offline" ]; exit ;;
    *--offline*) exit 2 ;;
esac
[ ! -e "$UV_LOG.fail" ] || exit 1
if [ "$1" = venv ]; then
    while [ $# -gt 1 ]; do shift; done
    mkdir -p "$1/bin"
    ln -s "$REAL_PYTHON" "$1/bin/python"
    printf '#!/bin/sh\\necho ran "$@"\\n' >"$1/bin/island"
    chmod +x "$1/bin/island"
fi
"""


class Door:
    """A copy of the script in a folder of its own, and a PATH with little on it."""

    def __init__(self, folder: Path) -> None:
        self.root = folder / "a clone"
        self.root.mkdir()
        locks = (path.name for path in ROOT.glob("requirements*.lock"))
        for name in ("island", "pyproject.toml", *locks):
            shutil.copy(ROOT / name, self.root)
        self.bin = folder / "bin"
        self.bin.mkdir()
        for tool in TOOLS:
            found = shutil.which(tool)
            assert found is not None, tool
            (self.bin / tool).symlink_to(found)
        self.log = folder / "uv.log"

    def add(self, name: str, text: str) -> None:
        """Put a program on the PATH."""
        path = self.bin / name
        path.unlink(missing_ok=True)  # it may be a link to the machine's own
        path.write_text(text)
        path.chmod(path.stat().st_mode | stat.S_IXUSR)

    def add_python(self, version: str, *, modules: bool = True) -> None:
        """Put a ``python3`` on the PATH that answers as one of that version would."""
        good = tuple(map(int, version.split("."))) >= (3, 11)
        self.add(
            "python3",
            "#!/bin/sh\n"
            f"case $* in *ensurepip*) exit {0 if modules else 1} ;; esac\n"
            f"echo {version}\nexit {0 if good else 1}\n",
        )

    def run(
        self, *arguments: str, script: Path | None = None, cwd: Path | None = None
    ) -> subprocess.CompletedProcess[str]:
        """Run the script."""
        environment = {
            "PATH": str(self.bin),
            "UV_LOG": str(self.log),
            "REAL_PYTHON": sys.executable,
            "HOME": os.environ.get("HOME", "/"),
        }
        command = [str(self.bin / "sh"), str(script or self.root / "island"), *arguments]
        return subprocess.run(
            command, env=environment, cwd=cwd, capture_output=True, text=True, timeout=60
        )

    def calls(self) -> list[str]:
        """What uv was asked for since the last call."""
        lines = self.log.read_text().splitlines() if self.log.exists() else []
        self.log.unlink(missing_ok=True)
        return [" ".join(line.split()[1:3]) for line in lines]


@pytest.fixture
def door(tmp_path: Path) -> Door:
    return Door(tmp_path)


@pytest.fixture
def with_uv(door: Door) -> Door:
    door.add("uv", UV)
    door.add_python("3.12.1")
    return door


INSTALL = ["pip install", "pip install", "pip install"]
"""Whether the index answers, the lock file, the island itself."""
FIRST_USE = ["venv --quiet", *INSTALL]


def test_first_use_makes_everything_then_nothing_more(with_uv: Door) -> None:
    first = with_uv.run("demo", "--plain", "two words")
    assert (first.returncode, first.stdout) == (0, "ran demo --plain two words\n")
    assert "making .venv with Python 3.12.1" in first.stderr
    assert re.search(r"island: ready after \d+ s; \.venv takes \d+ MB\n$", first.stderr)
    assert re.search(r"up to \d+ MB to fetch, \d+ MB of disk \(\d+ MB free\)", first.stderr)
    assert with_uv.calls() == FIRST_USE
    second = with_uv.run("run")
    assert (second.stdout, second.stderr) == ("ran run\n", "")
    assert with_uv.calls() == []


def test_works_through_a_symlink_from_anywhere(with_uv: Door, tmp_path: Path) -> None:
    link = tmp_path / "link to island"
    link.symlink_to(with_uv.root / "island")
    found = with_uv.run("--help", script=link, cwd=Path("/"))
    assert found.stdout == "ran --help\n"
    assert (with_uv.root / ".venv" / "made-run").exists()


def test_changed_lock_installs_again(with_uv: Door) -> None:
    with_uv.run()
    with_uv.calls()
    with (with_uv.root / "requirements.lock").open("a") as lock:
        lock.write("# another line\n")
    with_uv.run()
    assert with_uv.calls() == INSTALL


def test_interrupted_start_is_repaired(with_uv: Door) -> None:
    mark = Path(f"{with_uv.log}.fail")
    mark.touch()
    failed = with_uv.run()
    assert failed.returncode == 1
    assert failed.stderr.splitlines()[-1].startswith("island: error: uv could not make")
    mark.unlink()
    with_uv.calls()
    assert with_uv.run("run").stdout == "ran run\n"
    assert with_uv.calls() == FIRST_USE


def test_failed_installation_is_done_again(with_uv: Door) -> None:
    with_uv.run()
    lock = with_uv.root / "requirements.lock"
    lock.write_text(lock.read_text() + "#\n")
    mark = Path(f"{with_uv.log}.fail")
    mark.touch()
    failed = with_uv.run()
    assert failed.returncode == 1
    assert "could not install requirements.lock" in failed.stderr.splitlines()[-1]
    mark.unlink()
    lock.write_text(lock.read_text()[:-2])
    with_uv.calls()
    with_uv.run()
    assert with_uv.calls() == INSTALL, "the old stamp is gone"


def test_environment_that_lost_its_python_is_replaced(with_uv: Door) -> None:
    with_uv.run()
    python = with_uv.root / ".venv" / "bin" / "python"
    python.unlink()
    python.symlink_to("/nowhere/python")
    with_uv.calls()
    again = with_uv.run("run")
    assert again.stdout == "ran run\n"
    assert "replacing a .venv that does not work" in again.stderr
    assert with_uv.calls() == FIRST_USE


def test_environment_of_an_older_door_is_replaced_too(with_uv: Door) -> None:
    """It left no mark, and a stamp when it was done."""
    with_uv.run()
    (with_uv.root / ".venv" / "made-by-island").unlink()
    (with_uv.root / ".venv" / "bin" / "python").unlink()
    assert with_uv.run("run").stdout == "ran run\n"


def refused(door: Door) -> str:
    """The one line of the door, which left ``.venv`` and the package index alone."""
    result = door.run("run")
    assert (result.returncode, result.stdout, door.calls()) == (1, "", [])
    return result.stderr


@pytest.mark.parametrize("works", [True, False])
def test_environment_of_somebody_else_is_neither_removed_nor_changed(
    with_uv: Door, works: bool
) -> None:
    python = with_uv.root / ".venv" / "bin" / "python"
    python.parent.mkdir(parents=True)
    python.symlink_to(sys.executable if works else "/nowhere/python")
    (with_uv.root / ".venv" / "precious").write_text("work of weeks")
    before = sorted(with_uv.root.glob(".venv/**/*"))
    venv = with_uv.root / ".venv"
    assert refused(with_uv).startswith(f"island: error: {venv} was not made by ./island; move it")
    assert sorted(with_uv.root.glob(".venv/**/*")) == before
    assert (venv / "precious").read_text() == "work of weeks"


def test_a_file_or_a_dead_link_in_place_of_the_environment_is_left(with_uv: Door) -> None:
    venv = with_uv.root / ".venv"
    venv.symlink_to("/nowhere")
    assert "was not made by ./island" in refused(with_uv)
    venv.unlink()
    venv.write_text("mine")
    assert "was not made by ./island" in refused(with_uv)
    assert venv.read_text() == "mine"


@pytest.mark.skipif(os.geteuid() != 0, reason="gives files away, as only root may")
def test_environment_of_another_user_is_left(with_uv: Door) -> None:
    with_uv.run()
    with_uv.calls()
    venv = with_uv.root / ".venv"
    (venv / "made-run").unlink()
    (venv / "bin" / "python").unlink()
    os.chown(venv, 4242, 4242)
    assert f"{venv} belongs to another user; run ./island as that one" in refused(with_uv)
    assert (venv / "bin" / "island").exists()


def test_dev_brings_the_tests_too(with_uv: Door) -> None:
    assert with_uv.run("dev").returncode == 0
    assert "requirements-dev.lock" in with_uv.log.read_text()
    with_uv.calls()
    assert with_uv.run("run").stdout == "ran run\n"
    assert with_uv.calls() == [], "what the tests need includes what a run needs"


def test_replay_and_bench_bring_the_solver_of_the_recordings(with_uv: Door) -> None:
    assert with_uv.run("run").returncode == 0
    assert "requirements-osqp.lock" not in with_uv.log.read_text()
    assert with_uv.run("replay", "folder").stdout == "ran replay folder\n"
    assert "requirements-osqp.lock" in with_uv.log.read_text()
    with_uv.calls()
    for command in ("bench", "replay", "run"):
        with_uv.run(command)
    assert with_uv.calls() == [], "what the comparison needs includes what a run needs"


def test_offline_is_one_clear_line_and_nothing_is_kept(with_uv: Door) -> None:
    mark = Path(f"{with_uv.log}.offline")
    mark.touch()
    failed = with_uv.run()
    assert failed.returncode == 1
    assert "no package index answers" in failed.stderr.splitlines()[-1]
    assert not (with_uv.root / ".venv" / "made-run").exists()
    mark.unlink()
    assert with_uv.run("run").stdout == "ran run\n"


def test_offline_is_no_matter_when_all_is_there(with_uv: Door) -> None:
    """A lock file that changed in a comment needs nothing new."""
    with_uv.run()
    Path(f"{with_uv.log}.offline").touch()
    with_uv.add("uv", UV.replace("*--offline*) exit 2 ;;", ""))
    with (with_uv.root / "requirements.lock").open("a") as lock:
        lock.write("# another line\n")
    assert with_uv.run("run").stdout == "ran run\n"


def test_too_little_disk_is_one_line_before_anything_is_fetched(with_uv: Door) -> None:
    with_uv.add("df", "#!/bin/sh\necho head\necho / 1 1 51200 50% /\n")
    failed = with_uv.run()
    assert failed.returncode == 1
    assert "MB of disk in" in failed.stderr.splitlines()[-1]
    assert failed.stderr.splitlines()[-1].endswith(", 50 MB are free")
    assert with_uv.calls() == ["venv --quiet"]


PIP = """\
Collecting numba==0.68.1 (from -r /a clone/requirements.lock (line 211))
  Downloading numba-0.68.1-cp311-cp311-manylinux_2_27_x86_64.whl.metadata (2.9 kB)
Collecting rich==15.0.0 (from -r /a clone/requirements.lock (line 300))
  Using cached rich-15.0.0-py3-none-any.whl (310 kB)
Processing {folder}/editables-0.6-py3-none-any.whl (from -r /a clone/requirements.lock (line 213))
Downloading numba-0.68.1-cp311-cp311-manylinux_2_27_x86_64.whl (3.8 MB)
Installing collected packages: rich, numba, editables
Successfully installed editables-0.6 numba-0.68.1 rich-15.0.0
"""
"""What pip prints: the metadata first, files in a cache, files in a folder (``--find-links``)."""


def test_each_package_is_told_once_with_its_size(door: Door, tmp_path: Path) -> None:
    (tmp_path / "editables-0.6-py3-none-any.whl").write_bytes(bytes(1_240_000))
    door.add_python("3.12.1")
    python = door.bin / "python3"
    said = tmp_path / "pip.txt"
    said.write_text(PIP.format(folder=tmp_path))
    made = f"""case $* in
*'-m venv'*) mkdir -p '{door.root}/.venv/bin'; ln -s {python} '{door.root}/.venv/bin/python'
  printf '#!/bin/sh\necho ran\n' >'{door.root}/.venv/bin/island'
  chmod +x '{door.root}/.venv/bin/island'; exit 0 ;;
*--require-hashes*) cat {said}; exit 0 ;;
*'pip --disable'*) exit 0 ;;
"""
    door.add("python3", python.read_text().replace("case $* in ", made))
    result = door.run("run")
    assert result.stdout == "ran\n", result.stderr
    assert [line for line in result.stderr.splitlines() if line.startswith("island:   ")] == [
        "island:   rich 15.0.0, 310 kB, from pip's cache",
        "island:   editables 0.6, 1.2 MB, from a folder of this machine",
        "island:   numba 0.68.1, 3.8 MB",
        "island:   all there; unpacking",
    ]


def error_of(result: subprocess.CompletedProcess[str]) -> str:
    """The one line of an error."""
    assert result.returncode == 1
    assert result.stdout == ""
    assert result.stderr.count("\n") == 1
    return result.stderr


def test_no_python_is_one_line(door: Door) -> None:
    assert "needs Python 3.11, 3.12 or 3.13 on PATH, found none;" in error_of(door.run())


def test_old_python_is_one_line(door: Door) -> None:
    door.add_python("3.9.18")
    assert "found python3 3.9.18;" in error_of(door.run())


def test_missing_venv_module_names_the_package(door: Door) -> None:
    door.add_python("3.11.2", modules=False)
    assert "sudo apt-get install python3.11-venv" in error_of(door.run())


def test_shell_scripts_are_clean() -> None:
    checker = Path(sys.executable).with_name("shellcheck")
    if not checker.exists():
        pytest.skip("shellcheck is not installed")
    scripts = [ROOT / "island", ROOT / "tools" / "lock", ROOT / ".ci" / "run"]
    result = subprocess.run([checker, *scripts], capture_output=True, text=True, timeout=60)
    assert result.stdout == ""
