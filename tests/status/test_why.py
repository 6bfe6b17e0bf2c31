# SPDX-License-Identifier: Apache-2.0
"""One sentence about any status."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given, settings

from safety_island.control.status import Mode, MpcStatus
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.messages import codec
from safety_island.messages.status import STATUS, decode_status
from safety_island.status.why import flows, why
from tests.messages.strategies import messages
from tests.status.samples import NOT_FINITE, ODOMETRY, STALE, TRAJECTORY, sample

SILENT: dict[str, Any] = {"state": State.SILENT, "published": False, "armed": False}
MANUAL: dict[str, Any] = {
    "state": State.READY,
    "reason": Reason.NOT_AUTONOMOUS,
    "operation_mode": Mode.STOP,
    "control_enabled": False,
}
LEADS = ("Nothing is being published: ", "No command went out", "The last", "The stop ramp")

SENTENCES = {
    "all is well": (
        sample(),
        "All is well: the island is ACTIVE, 1230 commands are sent, the last with +0.097 rad and"
        " -0.23 m/s²; the oldest input is trajectory (0.09 s).",
    ),
    "another publisher": (
        sample(other_control_writers=1),
        "Commands are sent, but another publisher is on /control/trajectory_follower/control_cmd;"
        " stop it, or the island.",
    ),
    "other publishers": (
        sample(other_control_writers=2),
        "Commands are sent, but 2 other publishers are on",
    ),
    "a second CAN master": (
        sample(foreign_can_frames=3),
        "Commands are sent, but another node on the CAN bus sends the island's frames; stop it, or"
        " the island.",
    ),
    "both": (
        sample(other_control_writers=1, foreign_can_frames=3),
        "Commands are sent, but another publisher is on /control/trajectory_follower/control_cmd,"
        " and another node on the CAN bus sends the island's frames; stop it, or the island.",
    ),
    "a second CAN master while it waits": (
        sample(**SILENT, reason=Reason.SECOND_CAN_MASTER, foreign_can_frames=3),
        "Nothing is being published: another node on the CAN bus sends the island's frames (3"
        " since a second without one); find and stop it; the island does not arm before.",
    ),
    "told to end": (
        sample(state=State.STOP, reason=Reason.SHUTTING_DOWN),
        "The stop ramp is being sent: the island was told to end; a vehicle that hears only CAN is"
        " stopped first; wait until it has stopped, or tell the island again to end it at once.",
    ),
    "with a warning": (
        sample({ODOMETRY: {"warnings": 5}}),
        "All is well, with a warning of odometry (AGE, CLOCK): the island is ACTIVE,",
    ),
    "refused samples": (
        sample({ODOMETRY: NOT_FINITE}, **STALE),
        "Nothing is being published: odometry is older than its limit (0.62 s, limit 0.50 s; the"
        " last 3 samples were refused: a used field is NaN or infinite); mend its source.",
    ),
    "one refused sample": (
        sample({ODOMETRY: NOT_FINITE | {"refused_in_a_row": 1}}, **STALE),
        "(0.62 s, limit 0.50 s; 1 sample was refused: a used field is NaN or infinite)",
    ),
    "a lost input": (
        sample({ODOMETRY: {"age": 0.62}}, **STALE),
        "Nothing is being published: odometry is older than its limit (0.62 s, limit 0.50 s);"
        " look at its publisher,",
    ),
    "a missing input": (
        sample(
            {TRAJECTORY: {"age": math.inf, "received": 0}},
            state=State.INIT,
            reason=Reason.WAITING_FOR_INPUT,
            subject=TRAJECTORY,
            published=False,
        ),
        "Nothing is being published: trajectory was never received, or no sample of it was accepted"
        " (never accepted; none received); start its publisher",
    ),
    "manual": (
        sample(**MANUAL),
        "Commands are sent, but the operation mode is not AUTONOMOUS with control enabled (it is"
        " STOP, control is not enabled); engage autonomous mode when the vehicle shall drive.",
    ),
    "degraded": (
        sample(degraded=True, overruns=3, missed_periods_total=7),
        "Commands are sent, but ticks come too late, again and again (3 late in a row, 7 periods"
        " missed so far, this tick took 1.0 ms); take load",
    ),
    "latched": (
        sample(**STALE | {"reason": Reason.LATCHED}),
        "Nothing is being published: the cause of the silence is gone, and the island waits to be"
        " armed (it was: odometry is older than its limit); leave autonomous mode and engage it"
        " again, or 'island arm'.",
    ),
    "the MPC": (
        sample(**SILENT, reason=Reason.MPC_FAILED, mpc_status=MpcStatus.TOO_FAR),
        "steering angle for too long (TOO_FAR, lateral error +0.03 m, yaw error -0.00 rad)",
    ),
    "a second commander": (
        sample(**SILENT, reason=Reason.SECOND_PUBLISHER, other_control_writers=1),
        "a second publisher is on the topic of the command (1 beside the first); stop it",
    ),
    "a second planner": (
        sample(
            {TRAJECTORY: {"other_writers": 2}},
            **SILENT,
            reason=Reason.SECOND_PUBLISHER,
            subject=TRAJECTORY,
        ),
        "a second publisher is on trajectory (2 beside the first); stop it",
    ),
    "the guard": (
        sample(**SILENT, reason=Reason.COMMAND_REFUSED, guard_refused=3),
        "the guard refused the command (no limit named; 3 refused so far);",
    ),
    "the outputs": (
        sample(**SILENT, reason=Reason.OUTPUT_FAILED, output_mode=1, output_failures=9),
        "no output could take the command (CAN_ONLY, 9 failures so far);",
    ),
    "a slow controller": (
        sample(**SILENT, reason=Reason.COMMAND_STALE, tick_time=0.61),
        "is older than 'timeout_thr_sec' (this tick took 610.0 ms);",
    ),
    "hold": (
        sample(**STALE | {"state": State.HOLD}),
        "The last command is being repeated: odometry is older",
    ),
    "stop": (
        sample(**STALE | {"state": State.STOP}),
        "The stop ramp is being sent: odometry is older",
    ),
    "partition": (
        sample(**SILENT, reason=Reason.PARTITION),
        "every input is older than its limit (the oldest input is trajectory (0.09 s));",
    ),
    "one tick": (
        sample(published=False),
        "No command went out in tick 1234, though the island is ACTIVE; its log tells why.",
    ),
    "one tick with a reason": (
        sample(published=False, reason=Reason.COMMAND_REFUSED),
        "No command went out in tick 1234: the guard refused the command (",
    ),
    "a reason of a newer island": (
        sample(**SILENT, reason=77),
        "Nothing is being published: for reason 77, unknown to this version; use the version",
    ),
    "a refusal of a newer island": (
        sample({ODOMETRY: NOT_FINITE | {"last_refusal": 77}}, **STALE),
        "were refused: reason 77, unknown to this version); use the version",
    ),
}


@pytest.mark.parametrize("name", SENTENCES)
def test_sentence(name: str) -> None:
    status, expected = SENTENCES[name]
    assert expected in why(status)


@pytest.mark.parametrize("state", State)
@pytest.mark.parametrize("reason", Reason)
def test_every_reason_gives_one_clean_sentence(state: State, reason: Reason) -> None:
    is_sent = state in (State.READY, State.ACTIVE)
    status = sample(state=state, reason=reason, subject=ODOMETRY, published=is_sent)
    sentence = why(status)
    assert sentence[0].isupper() and sentence.endswith(".") and "\n" not in sentence
    assert not set("{}`") & set(sentence)
    assert flows(status) == is_sent
    assert sentence.startswith(LEADS) != is_sent


@settings(max_examples=100, deadline=None)
@given(messages(STATUS))
def test_a_sentence_is_found_for_whatever_comes(message: dict[str, Any]) -> None:
    assert why(decode_status(codec.encode(STATUS, message)))
