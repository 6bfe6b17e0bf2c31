# SPDX-License-Identifier: Apache-2.0
"""The text forms of can-utils."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safety_island.can.candump import LogEntry, format_frame, format_line, parse_line
from safety_island.platform.interfaces import CanFrame
from tests.can.rig import REFERENCE_LINES, REFERENCE_STAMP_NS, triple


def test_frames_as_cansend_takes_them() -> None:
    assert tuple(map(format_frame, triple())) == REFERENCE_LINES
    assert format_frame(CanFrame(0x5, b"")) == "005#"


def test_lines_as_candump_writes_them() -> None:
    line = format_line(REFERENCE_STAMP_NS + 678_901, "can0", triple()[0])
    assert line == "(0000000012.345678) can0 100#48E80100E05EF8FF\n"
    assert format_line(1_700_000_000_000_000_000, "vcan0", CanFrame(1, b"")) == (
        "(1700000000.000000) vcan0 001#\n"
    )


@pytest.mark.parametrize(
    ("line", "entry"),
    [
        (
            "(12.345678) can0 100#0102",
            LogEntry(12.345678, CanFrame(0x100, b"\x01\x02"), channel="can0"),
        ),
        ("  (12.5)  can0   7Ff#aB  R\n", LogEntry(12.5, CanFrame(0x7FF, b"\xab"), channel="can0")),
        ("(12.5) can0 100# T", LogEntry(12.5, CanFrame(0x100, b""), channel="can0")),
        ("(12.5) can0 00000100#01", LogEntry(12.5, None, channel="can0")),
        ("(12.5) can0 100#R", LogEntry(12.5, None, channel="can0")),
        ("(12.5) can0 100#R8", LogEntry(12.5, None, channel="can0")),
        ("(12.5) can0 100##101020304", LogEntry(12.5, None, channel="can0")),
        (
            "(12.5) can0 20000040#0000000000000000",
            LogEntry(12.5, None, is_error=True, channel="can0"),
        ),
    ],
)
def test_lines_that_are_read(line: str, entry: LogEntry) -> None:
    assert parse_line(line) == entry


@pytest.mark.parametrize(
    "line",
    [
        "",
        "garbage",
        "(12.5) can0 100",
        "(12.5) can0 100#012",
        "(12.5) can0 100#010203040506070809",
        "(12.5) can0 1000#01",
        "(12.5) 100#01",
        "(twelve) can0 100#01",
        "12.5 can0 100#01",
        "can0  100   [8]  48 E8 01 00 E0 5E F8 FF",
        "(12.5) can0 100#01 X",
    ],
)
def test_lines_that_are_not_read(line: str) -> None:
    assert parse_line(line) is None


@given(
    st.integers(0, 2_000_000_000_000_000),
    st.integers(0, 0x7FF),
    st.binary(max_size=8),
)
def test_what_was_written_is_read(micros: int, identifier: int, data: bytes) -> None:
    frame = CanFrame(identifier, data)
    entry = parse_line(format_line(micros * 1000, "can0", frame))
    assert entry is not None
    assert entry.frame == frame
    assert entry.time_s == pytest.approx(micros / 1e6, abs=1e-6)
