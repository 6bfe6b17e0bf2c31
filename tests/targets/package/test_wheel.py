# SPDX-License-Identifier: Apache-2.0
"""What is built works where it is installed: wheel, sdist, and the wheel with kernels inside."""

from __future__ import annotations

import fcntl
import json
import platform
import shutil
import subprocess
import tarfile
import zipfile
from email import message_from_bytes
from email.message import Message
from pathlib import Path

import pytest

from safety_island import __version__
from safety_island.control.status import Refusal
from safety_island.kernel.library import LIBRARY_NAME, LIBRARY_PLACE
from safety_island.kernel.sources import sources_hash
from safety_island.targets.aot import linker
from safety_island.targets.aot.compile import entries
from safety_island.targets.aot.elf import read_elf, shared_needs
from safety_island.targets.aot.machines import AARCH64, X86_64, Machine, host
from safety_island.targets.errors import BuildError
from safety_island.targets.package import wheel
from safety_island.targets.package.wheel import build_wheel, check_portable, tag
from tests.targets.package.installed import ROOT, Installation, hatchling, unpacked

pytestmark = pytest.mark.timeout(900)  # the first of a session compiles the kernels
DATA = ("config", "demo")


def say(step: str) -> None:
    """Report nothing."""


@pytest.fixture(scope="session")
def sdist(shared: Path, worker_id: str) -> Path:
    """The sdist of this checkout."""
    return hatchling("sdist", ROOT, shared / f"sdist-{worker_id}")


@pytest.fixture(scope="session")
def plain_wheel(shared: Path, worker_id: str) -> Path:
    """The wheel for any machine."""
    return hatchling("wheel", ROOT, shared / f"wheel-{worker_id}")


@pytest.fixture(scope="session")
def wheel_of_sdist(sdist: Path, shared: Path, worker_id: str) -> Path:
    """The wheel that is built from the sdist, far from the checkout."""
    root = unpacked(sdist, shared / f"unpacked-{worker_id}")
    return hatchling("wheel", root, shared / f"second-{worker_id}")


@pytest.fixture(scope="session")
def platform_wheel(shared: Path) -> Path:
    """The wheel for this machine, with compiled kernels inside."""
    folder = shared / "platform"
    with (shared / "build.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        (made,) = list(folder.glob("*.whl")) or [build_wheel(host(), folder, say)]
    return made


@pytest.fixture(scope="session")
def plain(plain_wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Installation:
    """The plain wheel, installed with every extra."""
    return Installation(plain_wheel, tmp_path_factory.mktemp("plain"), ("compile", "osqp"))


@pytest.fixture(scope="session")
def bare(platform_wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Installation:
    """The platform wheel, installed without any extra: no Numba, no OSQP."""
    return Installation(platform_wheel, tmp_path_factory.mktemp("bare"), ())


@pytest.fixture(params=["plain", "bare"])
def installed(request: pytest.FixtureRequest) -> Installation:
    """Each of both."""
    found: Installation = request.getfixturevalue(request.param)
    return found


def names(path: Path) -> set[str]:
    """What a wheel holds."""
    with zipfile.ZipFile(path) as archive:
        return set(archive.namelist())


def metadata(path: Path, name: str = "METADATA") -> Message:
    """A file of a wheel's ``.dist-info``."""
    with zipfile.ZipFile(path) as archive:
        return message_from_bytes(
            archive.read(f"safety_island-{__version__}.dist-info/{name}"),
        )


def data_files() -> set[str]:
    """Every file of the package that is no module, by its place in a wheel."""
    package = ROOT / "src" / "safety_island"
    found = (path for path in package.rglob("*") if path.is_file() and path.suffix != ".pyc")
    return {path.relative_to(package.parent).as_posix() for path in found if path.suffix != ".py"}


def test_a_checkout_shows_the_data_of_the_package_where_users_know_it() -> None:
    package = ROOT / "src" / "safety_island"
    for place in (
        "config/Kconfig",
        "config/prj_actuation.conf",
        "config/boards/posix_actuation.conf",
        "config/can/safety_island.dbc",
        "demo/bridge/bridge-config.yaml",
        "demo/cyclonedds.xml",
    ):
        assert (ROOT / place).read_bytes() == (package / place).read_bytes()
        if (ROOT / ".git").exists():  # an sdist has copies
            assert (ROOT / place).samefile(package / place)


def test_wheel_and_sdist_hold_all_data(plain_wheel: Path, sdist: Path) -> None:
    wanted = data_files()
    assert "safety_island/config/Kconfig" in wanted
    assert "safety_island/py.typed" in wanted
    assert wanted <= names(plain_wheel)
    with tarfile.open(sdist) as archive:
        packed = {name.partition("/")[2] for name in archive.getnames()}
    assert {f"src/{name}" for name in wanted} <= packed
    documented = {
        path.relative_to(ROOT).as_posix()
        for folder in DATA
        for path in (*(ROOT / folder).glob("*"), *(ROOT / folder).glob("*/*"))
        if path.is_file()
    }
    assert documented | {"build.sh", "island", "LICENSE", "tools/hatch_hooks.py"} <= packed


def test_the_wheel_of_the_sdist_is_the_wheel_of_the_checkout(
    plain_wheel: Path, wheel_of_sdist: Path
) -> None:
    assert wheel_of_sdist.name == plain_wheel.name
    assert wheel_of_sdist.read_bytes() == plain_wheel.read_bytes()


def test_metadata_needs_the_compiler_only_where_no_kernels_are_inside(
    plain_wheel: Path, platform_wheel: Path
) -> None:
    needs = [
        set(metadata(path).get_all("Requires-Dist", [])) for path in (plain_wheel, platform_wheel)
    ]
    compiler = {text for text in needs[0] if text.startswith("numba") and ";" not in text}
    assert len(compiler) == 1
    assert needs[0] - needs[1] == compiler
    assert needs[1] < needs[0]
    assert not [text for text in needs[1] if text.startswith("osqp") and "extra" not in text]
    assert metadata(platform_wheel).get_all("Provides-Extra") == ["compile", "osqp"]


def test_links_of_the_description_work_on_a_package_index(plain_wheel: Path) -> None:
    about = metadata(plain_wheel)
    addresses = dict(text.split(", ", 1) for text in about.get_all("Project-URL", []))
    assert set(addresses) == {"Source", "Issues", "Documentation", "Changelog"}
    text = str(about.get_payload())
    assert "](docs/" not in text and "](CONTRIBUTING.md)" not in text
    assert f"]({addresses['Documentation']}/status.md)" in text


def test_the_platform_wheel_is_tagged_for_what_its_library_needs(platform_wheel: Path) -> None:
    assert metadata(platform_wheel, "WHEEL").get_all("Tag") == [f"py3-none-{tag(host())}"]
    assert platform_wheel.name.endswith(f"py3-none-{tag(host())}.whl")
    with zipfile.ZipFile(platform_wheel) as archive:
        library = archive.read(f"safety_island/{LIBRARY_PLACE}")
    check_library(library, host())


def check_library(library: bytes, machine: Machine) -> None:
    """A library for a machine, of every kernel, that needs no more than its wheel's tag says."""
    assert read_elf(library).machine == machine.elf_machine
    assert set(shared_needs(library)) <= {"libc.so.6"}
    versions = {version for needs in shared_needs(library).values() for version in needs}
    numbers = {tuple(map(int, version.removeprefix("GLIBC_").split("."))) for version in versions}
    assert max(numbers, default=(2, 0)) <= (2, 31)
    for entry in entries(on_demand=True):
        assert f"safety_island_{entry.name}".encode() in library


@pytest.mark.skipif(
    linker.find_compiler(AARCH64) is None,
    reason="no C compiler for aarch64 (gcc-aarch64-linux-gnu)",
)
@pytest.mark.slow
def test_the_wheel_for_the_other_processor_is_linked_here(tmp_path: Path) -> None:
    other = AARCH64 if platform.machine() == X86_64.name else X86_64
    made = build_wheel(other, tmp_path, say)
    assert made.name.endswith(f"-py3-none-manylinux_2_31_{other.name}.whl")
    with zipfile.ZipFile(made) as archive:
        check_library(archive.read(f"safety_island/{LIBRARY_PLACE}"), other)


CALL = """
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
extern const char safety_island_sources[65];
int32_t safety_island_check_trajectory(void *, void *, int64_t, double);
int main(void) {
  void *params = calloc(1, 1 << 20), *points = calloc(1, 1 << 20);
  printf("%s %d\\n", safety_island_sources, safety_island_check_trajectory(params, points, 1, 0.0));
  return 0;
}
"""


@pytest.mark.skipif(
    not shutil.which("qemu-aarch64") or not shutil.which("aarch64-linux-gnu-gcc"),
    reason="no emulator of aarch64 (qemu-user), or no compiler for it (gcc-aarch64-linux-gnu)",
)
@pytest.mark.slow
def test_the_kernels_in_the_wheel_for_aarch64_run(tmp_path: Path) -> None:
    made = build_wheel(AARCH64, tmp_path, say)
    with zipfile.ZipFile(made) as archive:
        library = tmp_path / LIBRARY_NAME
        library.write_bytes(archive.read(f"safety_island/{LIBRARY_PLACE}"))
    (tmp_path / "call.c").write_text(CALL)
    link = ["aarch64-linux-gnu-gcc", "-o", "call", "call.c", LIBRARY_NAME]
    subprocess.run(link, cwd=tmp_path, check=True)
    run = ["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu", "-E", "LD_LIBRARY_PATH=.", "./call"]
    said = subprocess.check_output(run, cwd=tmp_path, text=True)
    assert said.split() == [sources_hash(), str(int(Refusal.TOO_FEW_POINTS))]


NEEDS_A_CLOCK = """
int clock_gettime(int, void *);
int use(void *time) { return clock_gettime(0, time); }
"""
NEEDS_MATHS = """
double exp(double);
double use(double x) { return exp(x); }
"""


def small_library(folder: Path, source: str, *options: str) -> bytes:
    """Compile a shared library of a few lines."""
    (folder / "a.c").write_text(source)
    command = [*linker.needed_compiler().command, "-shared", "-fPIC", "-o", "a.so", "a.c", *options]
    subprocess.run(command, cwd=folder, check=True)
    return (folder / "a.so").read_bytes()


def test_a_library_that_needs_more_than_its_tag_promises_makes_no_wheel(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    data = small_library(tmp_path, NEEDS_A_CLOCK)
    check_portable(data, host())
    with monkeypatch.context() as patch:
        patch.setattr(wheel, "GLIBC", "2.16")
        with pytest.raises(BuildError, match=r"needs GLIBC_2\.\d+ of libc\.so\.6, newer than"):
            check_portable(data, host())
    data = small_library(tmp_path, NEEDS_MATHS, "-lm")
    with pytest.raises(BuildError, match=r"the library of kernels needs libm"):
        check_portable(data, host())


def test_a_wheel_is_made_in_a_clone_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(wheel, "source_tree", lambda: None)
    with pytest.raises(BuildError, match="made in a clone"):
        build_wheel(host(), tmp_path, say)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("config", "show", "-t", "posix"), "CONFIG_DDS_DOMAIN_ID=2"),
        (
            ("config", "show", "-t", "s32z270dc2_rtu0_r52@D"),
            "CONFIG_CONTROL_CMD_OUTPUT_DDS_AND_CAN=y",
        ),
        (
            ("can", "send", "--angle", "0.125", "--velocity", "12.25", "--print"),
            "100#48E8010000000000",
        ),
        (("run", "--platform", "sim", "--duration", "2"), ""),
        (("params", "show"), "wheel_base"),
        (("can", "dbc"), "BO_ 256"),
    ],
    ids=lambda value: " ".join(value[:3]) if isinstance(value, tuple) else "",
)
def test_commands_work_where_a_wheel_is_installed(
    installed: Installation, arguments: tuple[str, ...], said: str
) -> None:
    result = installed.run(*arguments)
    assert result.returncode == 0, result.stderr
    assert said in result.stdout
    assert "island: error" not in result.stderr


@pytest.mark.live
def test_the_demo_drives_where_a_wheel_is_installed(installed: Installation) -> None:
    result = installed.run("demo", "--plain", "--duration", "16")
    judged = [line.strip() for line in result.stdout.splitlines() if line.startswith("    ")]
    assert len(judged) > 3, result.stderr
    # Ticks are missed when tests keep every core busy; all else is the drive's own doing.
    failed = [line for line in judged if not line.startswith("ok") and "missed" not in line]
    assert all(line.startswith(("first Control", "the machine was busy")) for line in failed)
    assert "Traceback" not in result.stderr


@pytest.mark.live
def test_the_bridge_needs_no_file(installed: Installation, domain_pair: tuple[int, int]) -> None:
    domains = ("--from", str(domain_pair[0]), "--to", str(domain_pair[1]))
    result = installed.run("bridge", *domains, "--duration", "0.2")
    assert result.returncode == 0, result.stderr
    assert result.stderr.count("waiting for a publisher") == 6


def test_bench_tick_works_with_its_extra(plain: Installation) -> None:
    result = plain.run("bench", "tick", "--rounds", "1", "--solver", "daqp")
    assert result.returncode == 0, result.stderr
    assert result.stdout.splitlines()[1].startswith("daqp")


@pytest.mark.parametrize(
    ("arguments", "extra"),
    [
        (("bench", "tick"), "osqp"),
        (("replay", "--solver", "osqp", str(ROOT / "tests/golden/data/u_turn")), "osqp"),
        (("build", "-t", "posix"), "compile"),
    ],
    ids=["bench", "replay", "build"],
)
def test_a_missing_extra_is_one_line_before_anything_else(
    bare: Installation, arguments: tuple[str, ...], extra: str
) -> None:
    result = bare.run(*arguments)
    assert result.returncode == 2
    assert result.stdout == ""
    (line,) = result.stderr.splitlines()
    assert f'install "safety-island[{extra}]"' in line


def test_a_plain_wheel_without_its_compiler_says_so_in_one_line(
    plain_wheel: Path, tmp_path: Path
) -> None:
    lacking = Installation(plain_wheel, tmp_path, ())
    result = lacking.run("run", "--platform", "sim", "--duration", "1")
    assert (result.returncode, result.stdout) == (2, "")
    (line,) = result.stderr.splitlines()
    assert "'numba', which is not installed" in line
    assert lacking.run("config", "show", "-t", "posix").returncode == 0


def test_osqp_works_from_the_library_with_its_extra_alone(
    platform_wheel: Path, tmp_path: Path
) -> None:
    pytest.importorskip("osqp")
    with_osqp = Installation(platform_wheel, tmp_path, ("osqp",))
    run = ROOT / "tests" / "golden" / "data" / "u_turn" / "ctrl0.15_osqp.npz"
    result = with_osqp.run("replay", str(run), "--json")
    assert result.returncode == 0, result.stderr
    assert json.loads(result.stdout)["passed"]


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["plain_wheel", "platform_wheel"])
def test_a_target_is_built_where_a_wheel_is_installed_with_a_compiler(
    kind: str, posix_build: Path, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    """``posix_build`` has compiled the kernels already."""
    wheel: Path = request.getfixturevalue(kind)
    installation = Installation(wheel, tmp_path, ("compile",))
    result = installation.run("build", "-t", "posix", timeout=600)
    assert result.returncode == 0, result.stderr
    folder = installation.home / "build" / "posix"
    assert (folder / LIBRARY_NAME).read_bytes() == (posix_build / LIBRARY_NAME).read_bytes()
    assert (folder / "safety-island.pyz").exists()
    shutil.rmtree(folder)
