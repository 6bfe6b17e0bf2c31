# SPDX-License-Identifier: Apache-2.0
"""Words of others, from files and from the network, as they may be shown on a terminal."""

from __future__ import annotations

LONGEST = 1000
"""Characters of a line that are shown."""


def printable(line: str) -> str:
    """Return a line without what a terminal obeys; of a very long one the middle is left out."""
    if len(line) > LONGEST:
        line = f"{line[: LONGEST // 2]} [...] {line[-LONGEST // 2 :]}"
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in line)
