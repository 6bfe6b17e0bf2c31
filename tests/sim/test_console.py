# SPDX-License-Identifier: Apache-2.0
"""Lines that act on the main compute while it drives."""

from __future__ import annotations

import os
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest

from safety_island.sim.console import JUMP_M, Console


class Pipe:
    """A console at the end of a pipe, and what it acts on."""

    def __init__(self) -> None:
        self.reading, self.writing = os.pipe()
        self.said: list[str] = []
        self.done: list[str] = []
        self.console = Console(self.said.append, self.reading)
        world = SimpleNamespace(
            engage=lambda: self.done.append("engage"),
            disengage=lambda: self.done.append("disengage"),
            stay_engaged=lambda: self.done.append("stay"),
        )
        self.main_compute: Any = SimpleNamespace(world=world, nan_odometry=False, frozen=set())

    def type(self, text: str) -> None:
        os.write(self.writing, text.encode())
        self.console.poll(self.main_compute)


@pytest.fixture
def pipe() -> Iterator[Pipe]:
    found = Pipe()
    yield found
    os.close(found.reading)
    if not found.console.is_closed:
        os.close(found.writing)


def test_nothing_is_waited_for(pipe: Pipe) -> None:
    pipe.console.poll(pipe.main_compute)
    assert not pipe.console.is_closed


def test_mode(pipe: Pipe) -> None:
    pipe.type("disengage\nengage\nstay\n\n")
    assert pipe.done == ["disengage", "engage", "stay"]


def test_a_line_may_come_in_pieces(pipe: Pipe) -> None:
    pipe.type("diseng")
    assert pipe.done == []
    pipe.type("age\n")
    assert pipe.done == ["disengage"]


def test_faults(pipe: Pipe) -> None:
    pipe.type("nan\nfreeze odometry\nfreeze trajectory\nthaw odometry\n")
    assert pipe.main_compute.nan_odometry
    assert pipe.main_compute.frozen == {"trajectory"}
    pipe.type("number\n")
    assert not pipe.main_compute.nan_odometry


def test_the_trajectory_jumps_and_returns(pipe: Pipe) -> None:
    pipe.type("jump\n")
    assert pipe.main_compute.trajectory_offset == JUMP_M
    pipe.type("return\n")
    assert pipe.main_compute.trajectory_offset == 0.0


def test_end_of_the_drive_and_of_the_input(pipe: Pipe) -> None:
    pipe.type("end\n")
    assert (pipe.console.has_ended, pipe.console.is_closed) == (True, False)
    os.close(pipe.writing)
    pipe.console.poll(pipe.main_compute)
    assert pipe.console.is_closed


@pytest.mark.parametrize("line", ["fly", "freeze", "freeze control", "nan on"])
def test_what_is_no_command_is_told_with_those_that_are(pipe: Pipe, line: str) -> None:
    pipe.type(f"{line}\n")
    (text,) = pipe.said
    assert text.startswith(f"unknown command '{line}'; there are: engage, disengage, ")
    assert "odometry" in text
