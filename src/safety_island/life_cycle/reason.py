# SPDX-License-Identifier: Apache-2.0
"""Why the island is in its state: every reason, what it means and what to do about it.

The table makes docs/status.md and the sentences of ``island status --why``.
"""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple


class Reason(IntEnum):
    """The numbers are those of the status message; ``{subject}`` is an input of the table."""

    NONE = 0
    DISCOVERING = 1
    WAITING_FOR_INPUT = 2
    NO_TRAJECTORY = 3
    NOT_AUTONOMOUS = 4
    MODE_WRITER_GONE = 5
    INPUT_STALE = 6
    PARTITION = 7
    WRITER_FLAPPING = 8
    SECOND_PUBLISHER = 9
    SECOND_ISLAND = 10
    RESTARTED_WHILE_MOVING = 11
    STALLED = 12
    OVERRUN = 13
    CONTROLLER_FAULT = 14
    MPC_FAILED = 15
    COMMAND_STALE = 16
    COMMAND_REFUSED = 17
    OUTPUT_FAILED = 18
    LATCHED = 19
    SHUTTING_DOWN = 20
    SECOND_CAN_MASTER = 21


class Explanation(NamedTuple):
    """One row of the table of reasons; ``{subject}`` stands for the name of an input."""

    meaning: str
    action: str


EXPLANATIONS: dict[Reason, Explanation] = {
    Reason.NONE: Explanation("all is well", "nothing"),
    Reason.DISCOVERING: Explanation(
        "the island looks whether another one is on its domain",
        "wait; it takes `life_cycle.discovery_time`",
    ),
    Reason.WAITING_FOR_INPUT: Explanation(
        "{subject} was never received, or no sample of it was accepted",
        "start its publisher or the bridge; the refused samples of the status tell what is wrong"
        " with those that came",
    ),
    Reason.NO_TRAJECTORY: Explanation(
        "no trajectory has come that both controllers can follow",
        "publish a trajectory of at least three points",
    ),
    Reason.NOT_AUTONOMOUS: Explanation(
        "commands are sent, but the operation mode is not AUTONOMOUS with control enabled",
        "engage autonomous mode when the vehicle shall drive",
    ),
    Reason.MODE_WRITER_GONE: Explanation(
        "the publisher of the operation mode has gone, so nobody says that the island drives",
        "start it or the bridge again",
    ),
    Reason.INPUT_STALE: Explanation(
        "{subject} is older than its limit",
        "look at its publisher, the bridge and the network; the refused samples of the status"
        " tell whether samples come that cannot be used",
    ),
    Reason.PARTITION: Explanation(
        "every input is older than its limit",
        "look at the bridge and the network between main compute and island",
    ),
    Reason.WRITER_FLAPPING: Explanation(
        "publishers of {subject} have come and gone too often within a second",
        "find the publisher that restarts again and again, or the several that take turns",
    ),
    Reason.SECOND_PUBLISHER: Explanation(
        "a second publisher is on {subject}",
        "stop it; `gate.second_publisher: keep_first` keeps to the first one instead",
    ),
    Reason.SECOND_ISLAND: Explanation(
        "another island was on the domain first",
        "stop one of the two; this one does not arm before",
    ),
    Reason.RESTARTED_WHILE_MOVING: Explanation(
        "the island started, or started anew, in AUTONOMOUS mode while the vehicle moves",
        "leave autonomous mode and engage it again, or `island arm`",
    ),
    Reason.STALLED: Explanation(
        "the process stood still, or the machine slept",
        "look for what stopped it; leave autonomous mode and engage it again, or `island arm`",
    ),
    Reason.OVERRUN: Explanation(
        "ticks come too late, again and again",
        "take load from the machine, or give the island a longer period",
    ),
    Reason.CONTROLLER_FAULT: Explanation(
        "the controllers failed several times in a row",
        "read the log, and report it: this is a fault of the program",
    ),
    Reason.MPC_FAILED: Explanation(
        "the MPC has found no steering angle for too long",
        "look at the solver status, the lateral error and the yaw error in the status",
    ),
    Reason.COMMAND_STALE: Explanation(
        "the command of a controller is older than `timeout_thr_sec`",
        "look at the tick time in the status",
    ),
    Reason.COMMAND_REFUSED: Explanation(
        "the guard refused the command",
        "look at the guard's limits in the status, and report it",
    ),
    Reason.OUTPUT_FAILED: Explanation(
        "no output could take the command",
        "look at the CAN bus and the DDS domain; the log names the cause",
    ),
    Reason.LATCHED: Explanation(
        "the cause of the silence is gone, and the island waits to be armed",
        "leave autonomous mode and engage it again, or `island arm`",
    ),
    Reason.SHUTTING_DOWN: Explanation(
        "the island was told to end; a vehicle that hears only CAN is stopped first",
        "wait until it has stopped, or tell the island again to end it at once",
    ),
    Reason.SECOND_CAN_MASTER: Explanation(
        "another node on the CAN bus sends the island's frames",
        "find and stop it; the island does not arm before",
    ),
}
