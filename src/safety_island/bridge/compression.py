# SPDX-License-Identifier: Apache-2.0
"""Compressed routes: a sample, header included, as zstd in ``domain_bridge/msg/CompressedMsg``.

The same bytes as ROS 2's ``domain_bridge``: level 1, the size of the content in the zstd frame, and
one ``byte[] data`` around it.
"""

from __future__ import annotations

from struct import Struct

from backports import zstd

from safety_island.errors import IslandError

COMPRESSED = "domain_bridge/msg/CompressedMsg"
LEVEL = 1
MAX_CONTENT = 64 * 1024 * 1024
"""A sample that claims to be larger [B] is refused before memory is taken for it."""

_HEADER_LE = b"\x00\x01\x00\x00"
_PREFIX = Struct("<4sI")


class CompressionError(IslandError):
    """A sample that is no ``CompressedMsg``, or whose content cannot be restored."""


def compress(data: bytes) -> bytes:
    """Return the serialized CompressedMsg of a serialized message."""
    packed = zstd.compress(data, LEVEL)
    return _PREFIX.pack(_HEADER_LE, len(packed)) + packed


def decompress(data: bytes) -> bytes:
    """Return the serialized message in a serialized CompressedMsg.

    Raises CompressionError for what is no such message or larger than MAX_CONTENT.
    """
    if len(data) < _PREFIX.size or data[:2] != _HEADER_LE[:2]:
        raise CompressionError(f"{COMPRESSED}: no little-endian CDR")
    size = _PREFIX.unpack_from(data)[1]
    packed = data[_PREFIX.size : _PREFIX.size + size]
    if len(packed) < size:
        raise CompressionError(f"{COMPRESSED}: {size} bytes announced, {len(packed)} there")
    try:
        content = zstd.get_frame_info(packed).decompressed_size
        if content is None or content > MAX_CONTENT:
            raise CompressionError(f"{COMPRESSED}: content of {content} bytes is refused")
        return _restore(packed, content)
    except zstd.ZstdError as problem:
        raise CompressionError(f"{COMPRESSED}: {problem}") from None


def _restore(packed: bytes, size: int) -> bytes:
    """Restore one frame; never more than the ``size`` bytes that it announces."""
    decompressor = zstd.ZstdDecompressor()
    content = decompressor.decompress(packed, max_length=size)
    if len(content) != size or not decompressor.eof:
        raise CompressionError(f"{COMPRESSED}: the zstd frame is not whole")
    return content
