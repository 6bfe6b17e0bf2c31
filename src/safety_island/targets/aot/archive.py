# SPDX-License-Identifier: Apache-2.0
"""Writes static libraries: an ``ar`` archive with a symbol table, in the System V (GNU) form."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from struct import pack

_MAGIC = b"!<arch>\n"
_HEADER_SIZE = 60


def archive(members: Mapping[str, bytes], symbols: Mapping[str, Sequence[str]]) -> bytes:
    """Return an archive of object files; ``symbols`` names what each defines.

    Owner, time and mode are fixed, so the same members give the same bytes.
    """
    names = b"".join(f"{name}/\n".encode() for name in members)
    defined = [(symbol, name) for name in members for symbol in symbols[name]]
    texts = b"".join(symbol.encode() + b"\0" for symbol, _ in defined)
    place = len(_MAGIC) + _padded(4 + 4 * len(defined) + len(texts)) + _padded(len(names))
    places: dict[str, int] = {}
    for name, data in members.items():
        places[name] = place
        place += _padded(len(data))
    offsets = [places[name] for _, name in defined]
    table = pack(f">{len(offsets) + 1}I", len(offsets), *offsets) + texts
    parts = [_MAGIC, _member("/", table), _member("//", names)]
    at = 0
    for name, data in members.items():
        parts.append(_member(f"/{at}", data))
        at += len(name) + 2
    return b"".join(parts)


def _member(name: str, data: bytes) -> bytes:
    fields = f"{name:<16}{0:<12}{0:<6}{0:<6}{'100644':<8}{len(data):<10}`\n"
    return fields.encode("ascii") + data + b"\n" * (len(data) & 1)


def _padded(size: int) -> int:
    """Bytes that a member takes."""
    return _HEADER_SIZE + size + (size & 1)
