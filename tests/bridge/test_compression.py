# SPDX-License-Identifier: Apache-2.0
"""Compressed samples: the bytes of ROS 2's bridge, and no trust in what comes back."""

from __future__ import annotations

import struct
from contextlib import suppress

import pytest
from backports import zstd
from hypothesis import given
from hypothesis import strategies as st

from safety_island.bridge.compression import (
    MAX_CONTENT,
    CompressionError,
    compress,
    decompress,
)

SAMPLE = b"\x00\x01\x00\x00" + bytes(range(256)) * 8


def _message(packed: bytes) -> bytes:
    return b"\x00\x01\x00\x00" + struct.pack("<I", len(packed)) + packed


@given(st.binary(min_size=4, max_size=2000))
def test_round_trip(data: bytes) -> None:
    assert decompress(compress(data)) == data


def test_padding_after_the_message_does_not_matter() -> None:
    assert decompress(compress(SAMPLE) + bytes(3)) == SAMPLE


def test_looks_like_the_bytes_of_ros() -> None:
    """CDR header, length of ``data``, one zstd frame that tells its content's size."""
    message = compress(SAMPLE)
    assert message[:4] == b"\x00\x01\x00\x00"
    (size,) = struct.unpack_from("<I", message, 4)
    assert len(message) == 8 + size < len(SAMPLE)
    assert zstd.get_frame_info(message[8:]).decompressed_size == len(SAMPLE)
    assert zstd.decompress(message[8:]) == SAMPLE


def _bomb() -> bytes:
    compressor = zstd.ZstdCompressor()
    return compressor.compress(bytes(MAX_CONTENT + 1), mode=zstd.ZstdCompressor.FLUSH_FRAME)


def _without_size() -> bytes:
    compressor = zstd.ZstdCompressor(options={zstd.CompressionParameter.content_size_flag: 0})
    return compressor.compress(SAMPLE, mode=zstd.ZstdCompressor.FLUSH_FRAME)


HOSTILE = {
    "nothing": b"",
    "a header": b"\x00\x01\x00\x00",
    "big endian": b"\x00\x00" + compress(SAMPLE)[2:],
    "another encoding": b"\x00\x07" + compress(SAMPLE)[2:],
    "too long a length": compress(SAMPLE)[:-20],
    "an absurd length": b"\x00\x01\x00\x00\xff\xff\xff\xff" + compress(SAMPLE)[8:],
    "an empty frame": _message(b""),
    "no frame": _message(bytes(50)),
    "half a frame": _message(compress(SAMPLE)[8:60]),
    "a bomb": _message(_bomb()),
    "a frame of unknown size": _message(_without_size()),
}


@pytest.mark.parametrize("name", sorted(HOSTILE))
def test_refuses(name: str) -> None:
    with pytest.raises(CompressionError, match="domain_bridge/msg/CompressedMsg: "):
        decompress(HOSTILE[name])


@given(st.integers(0, len(compress(SAMPLE)) - 1), st.integers(1, 255))
def test_a_flipped_byte_is_refused_or_gives_bytes_of_that_size(at: int, flip: int) -> None:
    message = bytearray(compress(SAMPLE))
    message[at] ^= flip
    with suppress(CompressionError):
        assert len(decompress(bytes(message))) <= MAX_CONTENT
