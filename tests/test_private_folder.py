# SPDX-License-Identifier: Apache-2.0
"""A folder whose content may be run: whose it is, who could have written, what it leads through."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from safety_island.private_folder import distrust, make_private

needs_root = pytest.mark.skipif(os.geteuid() != 0, reason="gives files away, as only root may")
STRANGER = 4242


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder of our own, two levels below the test's."""
    folder = tmp_path / "cache" / "kernels"
    make_private(folder)
    return folder


def test_what_is_made_is_for_this_user_alone_whatever_the_umask(tmp_path: Path) -> None:
    before = os.umask(0)
    try:
        make_private(tmp_path / "a" / "b")
    finally:
        os.umask(before)
    assert {(tmp_path / name).stat().st_mode & 0o777 for name in ("a", "a/b")} == {0o700}
    assert distrust(tmp_path / "a" / "b") == ""


def test_an_own_folder_with_own_files_is_trusted(folder: Path) -> None:
    (folder / "code.nbc").write_text("")
    (folder / "ir").mkdir()
    assert distrust(folder) == ""


@pytest.mark.parametrize("mode", [0o777, 0o770, 0o702, 0o1777])
def test_a_folder_that_others_can_write_to_is_not_trusted(folder: Path, mode: int) -> None:
    folder.chmod(mode)
    assert distrust(folder) == f"{folder} can be written by others (mode {mode:o})"


@needs_root
def test_row_90_a_folder_of_another_user_is_not_trusted(folder: Path) -> None:
    os.chown(folder, STRANGER, STRANGER)
    assert distrust(folder) == f"{folder} belongs to user {STRANGER}, not to 0"


@needs_root
def test_row_90_a_file_of_another_user_inside_is_not_trusted(folder: Path) -> None:
    planted = folder / "planted.nbi"
    planted.write_text("")
    os.chown(planted, STRANGER, STRANGER)
    assert distrust(folder) == f"{planted} belongs to user {STRANGER}, not to 0"


@needs_root
def test_a_folder_below_one_of_another_user_is_not_trusted(folder: Path) -> None:
    os.chown(folder.parent, STRANGER, STRANGER)
    assert distrust(folder) == f"{folder.parent} belongs to user {STRANGER}, not to 0"


@needs_root
def test_row_90_a_link_that_another_user_made_on_the_way_is_not_trusted(
    folder: Path, tmp_path: Path
) -> None:
    link = tmp_path / "link"
    link.symlink_to(folder.parent)
    assert distrust(link / "kernels") == ""
    os.chown(link, STRANGER, STRANGER, follow_symlinks=False)
    assert distrust(link / "kernels") == f"{link} belongs to user {STRANGER}, not to 0"


def test_row_90_a_link_in_place_of_the_folder_is_not_trusted(folder: Path, tmp_path: Path) -> None:
    link = tmp_path / "link"
    link.symlink_to(folder)
    assert distrust(link) == f"{link} is not a folder but a link"


def test_row_90_a_link_inside_is_not_trusted(folder: Path) -> None:
    (folder / "longitudinal_step.lock").symlink_to("/etc/passwd")
    assert "is a link" in distrust(folder)


def test_a_folder_below_one_that_anybody_can_write_to_is_trusted_only_if_sticky(
    folder: Path,
) -> None:
    """Without the sticky bit another user could put a folder of his own in its place."""
    folder.parent.chmod(0o777)
    assert distrust(folder) == f"{folder.parent} can be written by others (mode 777)"
    folder.parent.chmod(0o1777)
    assert distrust(folder) == ""
