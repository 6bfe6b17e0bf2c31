# SPDX-License-Identifier: Apache-2.0
"""Text files of others: what is read, and why one is not."""

from __future__ import annotations

from pathlib import Path

import pytest

from safety_island.text_file import MAX_BYTES, UnreadableError, read_text


@pytest.mark.parametrize("data", [b"a: \xc3\xa4\n", b"\xef\xbb\xbfa: \xc3\xa4\n"])
def test_utf8_with_and_without_a_byte_order_mark(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "a"
    path.write_bytes(data)
    assert read_text(path) == "a: ä\n"


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("none", "No such file or directory"),
        (".", "Is a directory"),
        ("a\0b", "embedded null byte"),
        ("latin", r"it is not UTF-8 text \(at byte 3\)"),
        ("endless", f"it has more than {MAX_BYTES} bytes"),
    ],
)
def test_why_a_file_cannot_be_read(tmp_path: Path, name: str, why: str) -> None:
    (tmp_path / "latin").write_bytes(b"a: \xe4")
    (tmp_path / "endless").symlink_to("/dev/zero")
    with pytest.raises(UnreadableError, match=f"^{why}$"):
        read_text(tmp_path / name)


def test_the_limit_itself_is_read(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"12345")
    assert read_text(tmp_path / "a", 5) == "12345"
    with pytest.raises(UnreadableError):
        read_text(tmp_path / "a", 4)
