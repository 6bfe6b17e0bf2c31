# SPDX-License-Identifier: Apache-2.0
"""Small changes of good files that make bad ones, the same for the same seed."""

from __future__ import annotations

import io
import random
import re
import zipfile
from collections.abc import Callable

Change = Callable[[bytes, random.Random], bytes]

WORDS = tuple(
    word if isinstance(word, bytes) else word.encode()
    for word in (
        # numbers that are too much for somebody
        *("0", "-1", "-0.0", "1e999", "nan", ".nan", "-.inf", "9" * 5000, "1e-5000", "0x", "0b_"),
        *("2147483648", "-9223372036854775809", "18446744073709551616", "1:99:99", "2001-99-99"),
        # texts
        *("\ufeff", "\u2028", "\x85", "\u202e", "\x1b[2J", "%s%n", "${HOME}", "A" * 70_000),
        *(b"\x00", b"\xff\xfe", b"\xc3", b"\xed\xa0\x80", b"\r", b"\n\n", b"\t", b"\x7f", b"\\"),
        # structure
        *("[" * 2000, "{" * 2000, "(" * 2000, "]", "}", "- " * 500, "? " * 500, "'", '"', "#"),
        *("&a ", "*a", "<<: ", "!!int ", "!!binary ", "!!python/object:os.system ", "!!timestamp "),
        *(
            "---\n",
            "...\n",
            "%YAML 9.9\n",
            ": ",
            "| ",
            ">- ",
            "<!DOCTYPE a [",
            "&lt;",
            "]]>",
            "<a>",
        ),
        *(
            "CONFIG_",
            "=",
            "\nsource ",
            "\nif ",
            "\nendif\n",
            " SG_ ",
            "BO_ ",
            "CM_ ",
            ";",
            "@",
            "/*",
        ),
    )
)
"""What is put into a file: each has broken some reader of something once."""


def _span(data: bytes, rng: random.Random, longest: int = 64) -> tuple[int, int]:
    start = rng.randrange(len(data) + 1)
    return start, min(len(data), start + rng.randrange(1, longest))


def _flip(data: bytes, rng: random.Random) -> bytes:
    at = rng.randrange(len(data) or 1)
    return (
        data[:at] + bytes(b ^ (1 << rng.randrange(8)) for b in data[at : at + 1]) + data[at + 1 :]
    )


def _byte(data: bytes, rng: random.Random) -> bytes:
    at = rng.randrange(len(data) or 1)
    return data[:at] + rng.choice((b"\x00", b"\xff", b"\x80", b"\x7f", b" ")) + data[at + 1 :]


def _cut(data: bytes, rng: random.Random) -> bytes:
    return data[: rng.randrange(len(data) + 1)]


def _leave_out(data: bytes, rng: random.Random) -> bytes:
    start, end = _span(data, rng)
    return data[:start] + data[end:]


def _repeat(data: bytes, rng: random.Random) -> bytes:
    start, end = _span(data, rng)
    return data[:start] + data[start:end] * rng.choice((2, 3, 200)) + data[end:]


def _put_in(data: bytes, rng: random.Random) -> bytes:
    at = rng.randrange(len(data) + 1)
    return data[:at] + rng.choice(WORDS) + data[at:]


def _other_word(data: bytes, rng: random.Random) -> bytes:
    """Replace one word or number; most files are made of these."""
    words = list(re.finditer(rb"[\w.+-]+", data))
    if not words:
        return data
    victim, other = rng.choice(words), rng.choice(words)
    new = other.group() if rng.random() < 0.4 else rng.choice(WORDS)
    return data[: victim.start()] + new + data[victim.end() :]


def _lines(data: bytes, rng: random.Random) -> bytes:
    """Move, repeat or indent a line."""
    lines = data.split(b"\n")
    one, other = rng.randrange(len(lines)), rng.randrange(len(lines))
    kind = rng.randrange(3)
    if kind == 0:
        lines[one], lines[other] = lines[other], lines[one]
    elif kind == 1:
        lines.insert(one, lines[other])
    else:
        lines[one] = rng.choice((b" ", b"    ", b"\t")) + lines[one]
    return b"\n".join(lines)


_CHANGES: tuple[Change, ...] = (
    *(_flip, _byte, _cut, _leave_out, _repeat, _lines),
    *(_put_in, _put_in, _other_word, _other_word, _other_word),
)


def mutated_member(good: bytes, rng: random.Random) -> bytes:
    """Return a zip archive of which one member, or its head, has changed; its sums are right."""
    archive, data = zipfile.ZipFile(io.BytesIO(good)), io.BytesIO()
    victim = rng.choice(archive.namelist())
    with zipfile.ZipFile(data, "w") as made:
        for name in archive.namelist():
            member = archive.read(name)
            if name == victim and rng.random() < 0.5:
                member = mutated(member[:128], rng) + member[128:]
            elif name == victim:
                member = mutated(member, rng)
            made.writestr(name, member)
    return data.getvalue()


def mutated(good: bytes, rng: random.Random) -> bytes:
    """Return a file with one change or some; ``good`` may be any bytes."""
    for _ in range(rng.choice((1, 1, 1, 2, 3, 8))):
        good = rng.choice(_CHANGES)(good, rng)
    return good
