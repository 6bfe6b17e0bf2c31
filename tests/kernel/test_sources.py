# SPDX-License-Identifier: Apache-2.0
"""The hash of the kernel sources: no edit, in whatever folder, leaves it as it was."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from safety_island.kernel.entries import all_entries
from safety_island.kernel.sources import PACKAGE, ROOMS, hash_of, sources_hash


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A copy of the kernel sources."""
    for room in ROOMS:
        shutil.copytree(PACKAGE / room, tmp_path / room)
    return tmp_path


def test_a_copy_of_the_same_sources_has_the_same_hash(package: Path) -> None:
    assert hash_of(package) == sources_hash()


@pytest.mark.parametrize("place", ["control/geometry.py", "control/records.py", "kernel/kernel.py"])
def test_any_edit_of_a_source_is_another_hash(package: Path, place: str) -> None:
    """Also in a file that only an imported function stands in."""
    with (package / place).open("a") as file:
        file.write("# one more\n")
    assert hash_of(package) != sources_hash()


def test_an_edit_in_a_folder_below_a_room_is_another_hash(package: Path) -> None:
    nested = package / "control" / "new" / "deep"
    nested.mkdir(parents=True)
    (nested / "rule.py").write_text("LIMIT = 1\n")
    first = hash_of(package)
    (nested / "rule.py").write_text("LIMIT = 2\n")
    assert len({sources_hash(), first, hash_of(package)}) == 3


def test_a_source_under_another_name_is_another_hash(package: Path) -> None:
    (package / "control" / "geometry.py").rename(package / "control" / "geometry2.py")
    assert hash_of(package) != sources_hash()


def test_a_note_changes_nothing(package: Path) -> None:
    (package / "control" / "notes.txt").write_text("not compiled")
    assert hash_of(package) == sources_hash()


def test_every_kernel_stands_in_a_room_of_kernels() -> None:
    """A kernel elsewhere would be compiled, and its edits would change no hash."""
    for entry in all_entries(on_demand=True):
        assert entry.python.__module__.split(".")[1] in ROOMS
