# SPDX-License-Identifier: Apache-2.0
"""Which bytes are text: as Python's own decoder says, but for NUL."""

from __future__ import annotations

import itertools
import random

import pytest

from safety_island.messages import codec
from safety_island.messages.trajectory import TRAJECTORY
from tests.input_gate.decode.damage import decode

EDGES = (0x01, 0x7F, 0x80, 0x8F, 0x90, 0x9F, 0xA0, 0xBF, 0xC0, 0xC1, 0xC2, 0xDF)
LEADS = (0xE0, 0xE1, 0xEC, 0xED, 0xEE, 0xEF, 0xF0, 0xF1, 0xF3, 0xF4, 0xF5, 0xFF)


def is_text(text: bytes) -> bool:
    """Whether the kernels take it for the name of a frame."""
    data = b"\0\1\0\0" + bytes(8) + (len(text) + 1).to_bytes(4, "little") + text + b"\0"
    return decode(TRAJECTORY, data + bytes(-len(data) % 4 + 4)) < 0


def python_says(text: bytes) -> bool:
    try:
        return "\0" not in text.decode()
    except UnicodeDecodeError:
        return False


def test_each_byte_alone() -> None:
    for byte in range(256):
        assert is_text(bytes([byte])) == python_says(bytes([byte])), byte


@pytest.mark.parametrize("lead", LEADS + EDGES)
def test_what_may_follow_the_first_byte(lead: int) -> None:
    for rest in itertools.chain(
        itertools.product(EDGES, repeat=1),
        itertools.product(EDGES, repeat=2),
        itertools.product(EDGES[1:9], (0x7F, 0x80, 0xBF, 0xC0), (0x7F, 0x80, 0xBF, 0xC0)),
    ):
        text = bytes([lead, *rest])
        assert is_text(text) == python_says(text), text


def test_random_texts_whole_and_damaged() -> None:
    dice = random.Random(3)
    for _ in range(300):
        text = bytearray("".join(dice.choices("aé€😀퟿\ue000􏿿", k=4)).encode())
        assert is_text(bytes(text))
        text[dice.randrange(len(text))] = dice.choice(EDGES + LEADS + (0,))
        assert is_text(bytes(text)) == python_says(bytes(text)), text


def test_the_generic_codec_agrees_about_the_empty_text() -> None:
    data = codec.encode(TRAJECTORY, {})
    assert decode(TRAJECTORY, data) < 0
    shorter = data[:12] + bytes(8)  # of length 0, without a NUL
    assert decode(TRAJECTORY, shorter) < 0 and not codec.decode(TRAJECTORY, shorter)["points"]
