# SPDX-License-Identifier: Apache-2.0
"""The library's own lines: in our form, and one of a kind in ten seconds."""

from __future__ import annotations

from safety_island.dds.library_log import Throttle

FAILED = "ddsi_udp_conn_write to udp/239.255.0.1:7900 failed with retcode -1"


def line(time_s: float, text: str) -> str:
    return f"{time_s:.6f} [2]        tev: {text}"


def test_a_line_like_one_before_is_counted_and_told_after_ten_seconds() -> None:
    throttle = Throttle()
    assert throttle(line(100.0, FAILED)) == FAILED
    for i in range(1, 100):
        assert throttle(line(100.0 + i / 10, FAILED.replace("7900", f"79{i:02}"))) is None
    assert throttle(line(110.1, FAILED)) == f"{FAILED} (99 more like it)"
    assert throttle(line(130.0, FAILED)) == FAILED


def test_lines_of_other_kinds_are_told_at_once() -> None:
    throttle = Throttle()
    assert throttle(line(100.0, FAILED)) == FAILED
    assert throttle(line(100.0, "malformed packet")) == "malformed packet"
    assert throttle("no stamp") == "no stamp"
    assert throttle("  ") is None


def test_a_clock_that_is_set_back_silences_nothing_for_long() -> None:
    throttle = Throttle()
    assert throttle(line(1000.0, FAILED)) == FAILED
    assert throttle(line(100.0, FAILED)) == FAILED


def test_memory_is_bounded() -> None:
    throttle = Throttle()
    for i in range(1000):
        throttle(line(100.0, "x" * i + "!"))
    assert len(throttle._told) <= 256
