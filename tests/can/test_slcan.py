# SPDX-License-Identifier: Apache-2.0
"""A serial adapter over a real line: its bytes, a line that is stuck, a plug that is pulled."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator

import pytest

from safety_island.can.backends import new_link
from safety_island.can.bus import BusLink
from safety_island.can.output import CanOutput
from safety_island.can.spec import BusSpec, parse_spec
from safety_island.command.mode import OutputMode
from safety_island.platform.interfaces import CanResult
from tests.can.rig import REFERENCE, REFERENCE_LINES, LogLines, triple, until
from tests.can.slcan_adapter import SlcanAdapter

BUDGET_S = 0.015


@pytest.fixture
def adapter() -> Iterator[SlcanAdapter]:
    made = SlcanAdapter()
    yield made
    made.close()


@pytest.fixture
def link(adapter: SlcanAdapter) -> Iterator[BusLink]:
    spec = parse_spec(f"slcan:{adapter.path},bitrate=500000,sleep_after_open=0")
    made = new_link(spec, time.monotonic_ns)
    made.open()
    assert until(lambda: adapter.commands.count("O") == 2)  # python-can says it twice
    yield made
    adapter.resume()
    made.close()


def test_the_bytes_on_the_line(link: BusLink, adapter: SlcanAdapter) -> None:
    assert link.send(triple(), 1.0).result is CanResult.SENT
    assert until(lambda: len(adapter.frames) == 3)
    sent = [line for line in adapter.commands if line[0] == "t"]
    assert sent == [f"t{line[:3]}8{line[4:]}" for line in REFERENCE_LINES]
    assert "S6" in adapter.commands


def test_a_line_that_was_cut_is_ended_before_the_next(link: BusLink, adapter: SlcanAdapter) -> None:
    descriptor = os.open(adapter.path, os.O_WRONLY | os.O_NOCTTY)
    os.write(descriptor, b"t1008AA")
    os.close(descriptor)
    link.discard()
    assert link.send(triple(), 1.0).result is CanResult.SENT
    assert until(lambda: len(adapter.frames) == 3)
    assert adapter.frames == list(triple())


def test_a_line_that_is_stuck_costs_no_more_than_the_budget(
    link: BusLink, adapter: SlcanAdapter
) -> None:
    """Row 56 with a real driver: its write time-out, and the thread behind it."""
    adapter.stall()
    results = [link.send(triple(sequence), BUDGET_S).result for sequence in range(400)]
    assert CanResult.TIMED_OUT in results
    first = results.index(CanResult.TIMED_OUT)
    assert results[:first] == [CanResult.SENT] * first


def test_after_a_stuck_line_nothing_old_leaves(link: BusLink, adapter: SlcanAdapter) -> None:
    log = LogLines()
    output = CanOutput(OutputMode.CAN_ONLY, link, 0.2, time.monotonic_ns, log)
    adapter.stall()
    assert until(lambda: not output.send(REFERENCE, 0))
    failed_from = output.counters.sent
    output.send(REFERENCE, 0)
    adapter.resume()
    assert until(lambda: output.send(REFERENCE, 0))
    newest = output.counters.commands - 1
    assert until(lambda: bool(adapter.frames) and sequence_of(adapter) == newest)
    status = [f for f in adapter.frames if f.arbitration_id == 0x102]
    numbers = [int.from_bytes(frame.data[2:4], "little") for frame in status]
    assert not [n for n in numbers if failed_from < n < newest], numbers


def sequence_of(adapter: SlcanAdapter) -> int:
    last = adapter.frames[-1]
    return int.from_bytes(last.data[2:4], "little") if last.arbitration_id == 0x102 else -1


def test_a_pulled_plug_is_an_interface_that_is_down() -> None:
    adapter = SlcanAdapter()
    spec = BusSpec("slcan", adapter.path, {"sleep_after_open": 0.0})
    link = new_link(spec, time.monotonic_ns)
    link.open()
    adapter.close()
    found = link.send(triple(), 1.0)
    assert found == (0, CanResult.INTERFACE_DOWN, found.events)
    link.reopen()
    assert until(lambda: not link.is_opening)
    assert link.send(triple(), 1.0).result is CanResult.NOT_OPEN
    link.close()
