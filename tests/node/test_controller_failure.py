# SPDX-License-Identifier: Apache-2.0
"""What a tick does when numbers, controllers or the program fail."""

from __future__ import annotations

import math

import pytest

from safety_island.control.status import MpcStatus
from safety_island.input_gate.reason import SampleReason
from safety_island.node.report import Outcome
from tests.node.rig import ROWS, FakeFollower, Rig


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_what_is_not_finite_is_never_sent(rig: Rig, follower: FakeFollower, value: float) -> None:
    follower.command["velocity"] = value
    follower.command["acceleration"] = -value
    rig.everything(ROWS)
    assert rig.tick().outcome is Outcome.NOT_FINITE
    assert rig.command() is None


@pytest.mark.parametrize("place", ["is_ready", "run_lateral", "sync"])
def test_an_exception_costs_one_tick(
    rig: Rig, follower: FakeFollower, monkeypatch: pytest.MonkeyPatch, place: str
) -> None:
    def fail(*_: object) -> None:
        raise ZeroDivisionError("on purpose")

    with monkeypatch.context() as patch:
        patch.setattr(follower, place, fail)
        rig.everything(ROWS)
        report = rig.tick()
    assert report.outcome is Outcome.FAULT
    assert report.detail.startswith(
        "ZeroDivisionError: on purpose (node/test_controller_failure.py:"
    )
    assert rig.command() is None
    rig.everything(ROWS)
    assert rig.tick().published


def test_an_exception_over_a_sample_refuses_that_sample(
    rig: Rig, follower: FakeFollower, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise ZeroDivisionError("on purpose")

    rig.everything(ROWS)
    rig.tick()
    monkeypatch.setattr(rig.node.inputs.items[2], "_offer", fail)
    rig.steering()
    assert rig.tick().published
    assert rig.node.inputs.items[2].refused == {SampleReason.FAULT: 1}
    assert any("ZeroDivisionError: on purpose" in line for line in rig.lines)


def test_a_failed_mpc_still_gives_a_command_and_says_why(rig: Rig, follower: FakeFollower) -> None:
    follower.lateral_status = MpcStatus.TOO_FAR
    rig.everything(ROWS)
    assert rig.tick().published
    assert any("no new steering angle: too far" in line for line in rig.lines)


def test_controllers_that_are_not_ready(rig: Rig, follower: FakeFollower) -> None:
    follower.ready = False
    rig.everything(ROWS)
    assert rig.tick().outcome is Outcome.NOT_READY
    follower.ready, follower.longitudinal_state = True, -1
    assert rig.tick().outcome is Outcome.NOT_READY
    assert rig.command() is None
