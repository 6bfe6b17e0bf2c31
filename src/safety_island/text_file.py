# SPDX-License-Identifier: Apache-2.0
"""Small text files that somebody else wrote: read with a limit, as UTF-8."""

from __future__ import annotations

from pathlib import Path

MAX_BYTES = 1 << 20
"""No configuration comes near it; a device or a recording named by mistake is beyond."""


class UnreadableError(Exception):
    """Why a text file cannot be read, in a few words; readers tell it with the file's name."""


def read_text(path: Path, limit: int = MAX_BYTES) -> str:
    """Return the text of a file; a byte order mark is no part of it. Raises UnreadableError."""
    try:
        with path.open("rb") as stream:
            data = stream.read(limit + 1)
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        raise UnreadableError(getattr(error, "strerror", None) or str(error)) from None
    if len(data) > limit:
        raise UnreadableError(f"it has more than {limit} bytes")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise UnreadableError(f"it is not UTF-8 text (at byte {error.start})") from None
