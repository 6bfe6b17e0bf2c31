# SPDX-License-Identifier: Apache-2.0
"""The frames in which positions and motions must be given."""

from __future__ import annotations

from collections.abc import Container


class _AnyFrame:
    """Contains every frame."""

    def __contains__(self, name: object) -> bool:
        return True


ANY_FRAME = _AnyFrame()


def frames(*names: str) -> Container[str]:
    """Return the spellings of the frames that are allowed: with and without a slash in front.

    An empty name allows any frame. Autoware's simulator writes ``/base_link``, ROS 2 ``base_link``.
    """
    if "" in names:
        return ANY_FRAME
    return frozenset(names) | frozenset(f"/{name}" for name in names)
