# SPDX-License-Identifier: Apache-2.0
"""JSON lines never wait for their reader."""

from __future__ import annotations

import json
import os
import threading
from collections.abc import Iterator

import pytest

from safety_island import __version__
from safety_island.cli.jsonlines import MAX_LINE, JsonLines, plain

Pipe = tuple[int, int]


def never(reason: str) -> None:
    raise AssertionError(reason)


@pytest.fixture
def pipe() -> Iterator[Pipe]:
    reading, writing = os.pipe()
    yield reading, writing
    os.close(writing)


def test_one_object_a_line(pipe: Pipe) -> None:
    lines = JsonLines(never, pipe[1])
    lines.write("tick", {"number": 1, "ages_s": {"odometry": 0.1234567}})
    lines.write("end", {})
    first, second = os.read(pipe[0], 1000).decode().splitlines()
    values = {"number": 1, "ages_s": {"odometry": 0.123457}}
    assert json.loads(first) == {"event": "tick", "version": __version__, **values}
    assert json.loads(second) == {"event": "end"}
    os.close(pipe[0])


def test_full_pipe_drops_instead_of_waiting(pipe: Pipe) -> None:
    lines = JsonLines(never, pipe[1])
    for _ in range(200):
        lines.write("tick", {"text": "x" * 2000})
    assert 0 < lines.dropped < 200
    kept = 0
    os.set_blocking(pipe[0], False)
    for line in os.read(pipe[0], 1 << 20).splitlines():
        kept += json.loads(line)["event"] == "tick"
    assert kept + lines.dropped == 200
    os.close(pipe[0])


def test_a_full_disk_drops_lines() -> None:
    full = os.open("/dev/full", os.O_WRONLY)
    lines = JsonLines(never, full)
    lines.write("tick", {"number": 1})
    os.close(full)
    assert lines.dropped == 1


def test_patient_lines_wait_for_their_reader(pipe: Pipe) -> None:
    lines = JsonLines(never, pipe[1], patient=True)
    read: list[bytes] = []

    def drain() -> None:
        while sum(map(len, read)) < 200 * 2000:
            read.append(os.read(pipe[0], 4096))

    reader = threading.Thread(target=drain)
    reader.start()
    for _ in range(200):
        lines.write("tick", {"text": "x" * 2000})
    reader.join(60)
    assert lines.dropped == 0
    os.close(pipe[0])


def test_line_that_could_block_half_written_is_dropped(pipe: Pipe) -> None:
    lines = JsonLines(never, pipe[1])
    lines.write("tick", {"text": "x" * MAX_LINE})
    assert lines.dropped == 1
    os.close(pipe[0])


def test_a_reader_that_went_away_is_told_once_and_is_no_error(pipe: Pipe) -> None:
    lost: list[str] = []
    lines = JsonLines(lost.append, pipe[1])
    os.close(pipe[0])
    for _ in range(3):
        lines.write("tick", {})
    assert (lost, lines.dropped) == (["broken pipe"], 1)


def test_a_terminal_that_was_closed_is_lost_as_well() -> None:
    controller, terminal = os.openpty()
    lost: list[str] = []
    lines = JsonLines(lost.append, terminal)
    os.close(controller)
    lines.write("tick", {})
    os.close(terminal)
    assert lost == ["input/output error"]


def test_json_has_no_nan() -> None:
    values = {"a": float("nan"), "b": [float("inf"), 1, True, "x"], "c": (1.0000000001,)}
    assert plain(values) == {"a": None, "b": [None, 1, True, "x"], "c": [1.0]}
