# SPDX-License-Identifier: Apache-2.0
"""The search for the library, on machines that are folders."""

from __future__ import annotations

from pathlib import Path

import pytest

from safety_island.dds.library.find import Machine, find
from safety_island.errors import ConfigurationError

ARM, INTEL = "aarch64", "x86_64"
WHEEL = "usr/lib/python3/dist-packages/cyclonedds.libs/libddsc-ad12c33a.so.11.0.1"
ORDER = (
    ("home/me/install/lib/libddsc.so.0", "LD_LIBRARY_PATH"),
    ("home/me/ros/lib/libddsc.so", "AMENT_PREFIX_PATH"),
    ("usr/local/lib/aarch64-linux-gnu/libddsc.so.0", ""),
    ("usr/local/lib/libddsc.so.0.10.5", ""),
    ("usr/lib/aarch64-linux-gnu/libddsc.so.0debian", ""),
    ("usr/lib/libddsc.so", ""),
    ("usr/lib64/libddsc.so.0", ""),
    ("opt/own/lib/libddsc.so.11", "ld.so.conf"),
    ("opt/ros/kilted/lib/libddsc.so", ""),
    ("opt/ros/jazzy/lib/aarch64-linux-gnu/libddsc.so.0", ""),
    ("opt/ros/humble/lib/libddsc.so", ""),
)
"""Every place that is looked at on aarch64, the first one first."""


def put(root: Path, *names: str) -> None:
    for name in names:
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(b"")


def machine(root: Path, processor: str = ARM, wheel: bool = False, **variables: str) -> Machine:
    packages = root / "usr/lib/python3/dist-packages" if wheel else None
    return Machine(root, processor, variables, packages)


@pytest.fixture
def pi(tmp_path: Path) -> Machine:
    """A machine with aarch64 that has the library everywhere but in a wheel."""
    put(tmp_path, *(name for name, _ in ORDER))
    put(tmp_path, "etc/ld.so.conf.d/own.conf", "usr/lib/x86_64-linux-gnu/libddsc.so")
    listing = tmp_path / "etc/ld.so.conf.d/own.conf"
    listing.write_text("# ours\n/opt/own/lib\n\ninclude other\n")
    return machine(
        tmp_path,
        LD_LIBRARY_PATH=f"/nowhere::{tmp_path}/home/me/install/lib",
        AMENT_PREFIX_PATH=f"{tmp_path}/home/me/ros",
    )


def test_the_places_come_in_order(pi: Machine) -> None:
    found = []
    for _ in ORDER:
        path = find(machine=pi)
        found.append(str(path.relative_to(pi.root)))
        path.unlink()
    assert found == [name for name, _ in ORDER]
    with pytest.raises(ConfigurationError, match="is not on this machine"):
        find(machine=pi)


def test_the_wheel_s_comes_first(pi: Machine) -> None:
    put(pi.root, WHEEL)
    with_wheel = Machine(
        pi.root, pi.processor, pi.environment, pi.root / "usr/lib/python3/dist-packages"
    )
    assert find(machine=with_wheel) == pi.root / WHEEL


def test_a_package_without_its_library_is_passed_over(tmp_path: Path) -> None:
    """ROS 2 has a Python package of that name, built against its own library."""
    put(tmp_path, "opt/ros/jazzy/lib/libddsc.so")
    found = find(machine=machine(tmp_path, wheel=True))
    assert found == tmp_path / "opt/ros/jazzy/lib/libddsc.so"


def test_the_library_of_another_processor_is_not_taken(tmp_path: Path) -> None:
    put(tmp_path, "usr/lib/x86_64-linux-gnu/libddsc.so")
    assert find(machine=machine(tmp_path, INTEL)).parent.name == "x86_64-linux-gnu"
    with pytest.raises(ConfigurationError):
        find(machine=machine(tmp_path, ARM))


def test_the_shortest_name_in_a_folder_is_taken(tmp_path: Path) -> None:
    put(tmp_path, *(f"usr/lib/{name}" for name in ("libddsc.so.0.10.2", "libddsc.so.0debian")))
    assert find(machine=machine(tmp_path)).name == "libddsc.so.0.10.2"
    put(tmp_path, "usr/lib/libddsc.so", "usr/lib/libddscxx.so")
    assert find(machine=machine(tmp_path)).name == "libddsc.so"


def test_nothing_is_one_line_with_what_was_looked_at(tmp_path: Path) -> None:
    (tmp_path / "usr/lib/aarch64-linux-gnu").mkdir(parents=True)
    with pytest.raises(ConfigurationError) as missing:
        find(machine=machine(tmp_path))
    said = str(missing.value)
    assert f"(aarch64); looked in {tmp_path}/usr/lib/aarch64-linux-gnu, {tmp_path}/usr/lib." in said
    assert "\n" not in said and "apt install cyclonedds-dev" in said and "--ddsc PATH" in said
    with pytest.raises(ConfigurationError, match="looked in no folder that exists"):
        find(machine=machine(tmp_path / "empty"))


def test_what_is_named_is_taken_and_nothing_else(pi: Machine, tmp_path: Path) -> None:
    put(tmp_path, "own/libddsc.so.0", "named.so")
    assert find(tmp_path / "own", pi) == tmp_path / "own/libddsc.so.0"
    assert find(tmp_path / "named.so", pi) == tmp_path / "named.so"
    variable = Machine(pi.root, ARM, {"SAFETY_ISLAND_DDSC": str(tmp_path / "own")}, None)
    assert find(machine=variable) == tmp_path / "own/libddsc.so.0"
    assert find(tmp_path / "named.so", variable) == tmp_path / "named.so"


def test_what_is_named_and_is_not_there_is_one_line(pi: Machine, tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match=r"^--ddsc .*/nothing: expected libddsc\.so"):
        find(tmp_path / "nothing", pi)
    wrong = Machine(pi.root, ARM, {"SAFETY_ISLAND_DDSC": "/nothing"}, None)
    with pytest.raises(ConfigurationError, match=r"^SAFETY_ISLAND_DDSC /nothing: expected"):
        find(machine=wrong)


def test_this_machine_s_library_is_that_of_the_wheel_when_it_is_installed() -> None:
    pytest.importorskip("cyclonedds")
    assert find(machine=Machine(environment={})).parent.name == "cyclonedds.libs"
