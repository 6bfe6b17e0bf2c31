# SPDX-License-Identifier: Apache-2.0
"""What a person sees of a status."""

from __future__ import annotations

import io
from typing import Any

import pytest
from hypothesis import given, settings
from rich.console import Console

from safety_island.cli.status.show import PlainShow, TerminalShow
from safety_island.cli.status.text import duration, plain_line
from safety_island.cli.status.view import draw
from safety_island.life_cycle.state import State
from safety_island.messages import codec
from safety_island.messages.status import STATUS, decode_status
from safety_island.messages.status_fields import Status
from tests.messages.samples import status_of_nothing
from tests.messages.strategies import messages
from tests.status.samples import NOT_FINITE, ODOMETRY, STALE, TRAJECTORY, sample

BAD = sample(
    {ODOMETRY: NOT_FINITE, TRAJECTORY: {"warnings": 4}},
    **STALE,
    arm_result=2,
    overruns=3,
    degraded=True,
    output_failures=4,
    guard_limits=1,
)


def seen(status: Status | None, age_s: float = 0.0, width: int = 100) -> str:
    """Draw a status as a terminal shows it."""
    console = Console(file=io.StringIO(), width=width, force_terminal=False)
    console.print(draw(status, age_s, "safety island"))
    assert isinstance(console.file, io.StringIO)
    return console.file.getvalue()


def test_all_is_well() -> None:
    text = seen(sample())
    for line in (
        "ACTIVE  All is well: the island is ACTIVE",
        "trajectory       91 ms  900 ms",
        "operation mode  12.5 s       -",
        "command     +0.097 rad, +0.012 rad/s, 6.49 m/s, -0.23 m/s²",
        "output      DDS_ONLY, 1230 sent",
        "mode        AUTONOMOUS, control enabled; island armed",
        "controller  DRIVE, MPC SOLVED, 3 iterations, 2 active, residual 3.2e-09",
        "errors      lateral +0.031 m, yaw -0.002 rad, stop in 63.0 m, target 6.56 m/s",
        "limits      STEERING_RATE, JERK",
        "guard       PASSED, 0 clamped, 0 refused so far",
        "tick        #1234 took 0.98 ms (lateral 0.41 ms, longitudinal 0.12 ms)",
        "time grid   woken 0.27 ms late, 0 missed",
        "memory      119 MiB",
    ):
        assert line in text


def test_what_is_wrong() -> None:
    text = seen(BAD)
    for part in (
        "SILENT  degraded  Nothing is being published: odometry is older",
        "3 not finite",
        "warning: clock",
        "4 failures",
        "island not armed, asked to arm: refused",
        "PASSED (ANGLE)",
        "3 late in a row",
    ):
        assert part in text


def test_before_the_controllers_ran() -> None:
    text = seen(status_of_nothing())
    for part in ("none went out in this tick", "not run yet", "none acts", "not asked"):
        assert part in text


def test_an_old_or_a_missing_status_says_so() -> None:
    assert "no status for 2.5 s: what stands here is old" in seen(sample(), 2.5)
    assert "no status came so far (2 s)" in seen(None, 2.0)


def test_a_narrow_terminal_still_shows_the_state() -> None:
    text = seen(BAD, width=60)
    assert "SILENT" in text
    assert max(len(line) for line in text.splitlines()) <= 60


@pytest.mark.parametrize(
    ("seconds", "shown"),
    [(0.00123, "1.23 ms"), (0.123, "123 ms"), (12.34, "12.3 s"), (float("inf"), "-")],
)
def test_duration(seconds: float, shown: str) -> None:
    assert duration(seconds) == shown


def test_a_plain_line_tells_the_figures_or_the_cause() -> None:
    assert plain_line(sample()) == (
        "ACTIVE  tick 1234  +0.097 rad, +0.012 rad/s, 6.49 m/s, -0.23 m/s²"
        "  lateral +0.031 m  0.98 ms"
    )
    alarm = plain_line(sample(other_control_writers=1))
    assert alarm.endswith("another publisher is on /control/trajectory_follower/control_cmd")
    assert plain_line(BAD).startswith("SILENT  tick 1234  Nothing is being published: odometry")


def test_plain_lines_come_once_a_second_and_at_each_change() -> None:
    stream = io.StringIO()
    with PlainShow(stream) as show:
        for now, status in (
            (0.0, sample(tick=1)),
            (0.5, sample(tick=2)),
            (0.6, sample(tick=3, state=State.SILENT)),
            (0.7, sample(tick=4, state=State.SILENT)),
            (1.6, sample(tick=5, state=State.SILENT)),
        ):
            show([status], now)
    ticks = [line.split()[2] for line in stream.getvalue().splitlines()]
    assert ticks == ["1", "3", "5"]


def test_the_live_view_keeps_the_newest_and_its_age() -> None:
    console = Console(file=io.StringIO(), width=100, force_terminal=True)
    with TerminalShow("title", 0.0, console) as show:
        show([], 0.0)
        show([sample(tick=1), sample(tick=77)], 0.05)
        show([], 2.05)
    assert isinstance(console.file, io.StringIO)
    text = console.file.getvalue()
    assert "no status came so far" in text and "#77 took" in text
    assert "no status for 2.0 s" in text and "#1 took" not in text


@settings(max_examples=50, deadline=None)
@given(messages(STATUS))
def test_whatever_comes_can_be_seen(message: dict[str, Any]) -> None:
    status = decode_status(codec.encode(STATUS, message))
    assert seen(status) and plain_line(status)
