# SPDX-License-Identifier: Apache-2.0
"""Statuses to show, and something that sends them in place of an island."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any, Self

from safety_island.control.status import ControllerLimit, LongitudinalState, Mode, MpcStatus
from safety_island.dds.config import DdsConfig
from safety_island.dds.participant import Participant
from safety_island.dds.topics import ARM, STATUS
from safety_island.input_gate.reason import SampleReason
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.messages.arm import decode_arm
from safety_island.messages.status import NO_VALUE, decode_status, encode_status
from safety_island.messages.status_fields import InputStatus, Status
from safety_island.messages.wire import Time
from tests.messages.samples import status_of_nothing

TRAJECTORY, ODOMETRY, STEERING, ACCELERATION, OPERATION_MODE = range(5)
AGES = (0.091, 0.016, 0.017, 0.018, 12.5)
LIMITS = (0.9, 0.5, 0.5, 0.5, float("inf"))

WELL: dict[str, Any] = {
    "tick": 1234,
    "commands": 1230,
    "memory": 125_000_000,
    "lateral_error": 0.031,
    "yaw_error": -0.002,
    "residual": 3.2e-9,
    "stop_dist": 63.0,
    "target_vel": 6.56,
    "command_angle": 0.097,
    "command_rate": 0.012,
    "command_velocity": 6.49,
    "command_acceleration": -0.23,
    "tick_time": 0.00098,
    "lateral_time": 0.00041,
    "longitudinal_time": 0.00012,
    "lateness": 0.00027,
    "controller_limits": ControllerLimit.STEERING_RATE | ControllerLimit.JERK,
    "sequence": 1229,
    "solver_iterations": 3,
    "active_constraints": 2,
    "state": State.ACTIVE,
    "operation_mode": Mode.AUTONOMOUS,
    "longitudinal_state": LongitudinalState.DRIVE,
    "mpc_status": MpcStatus.SOLVED,
    "guard_verdict": 0,
    "armed": True,
    "engaged": True,
    "control_enabled": True,
    "published": True,
}
STALE: dict[str, Any] = {
    "state": State.SILENT,
    "reason": Reason.INPUT_STALE,
    "latched_cause": Reason.INPUT_STALE,
    "subject": ODOMETRY,
    "armed": False,
    "published": False,
}
NOT_FINITE: dict[str, Any] = {
    "age": 0.62,
    "refused_in_a_row": 3,
    "last_refusal": SampleReason.NOT_FINITE,
}


def sample(inputs: dict[int, dict[str, Any]] | None = None, **changes: Any) -> Status:
    """Return a status where all is well, with changes to it."""
    nothing = status_of_nothing()
    rows = [_row(place, (inputs or {}).get(place, {})) for place in range(len(AGES))]
    made = WELL | changes | {"stamp": Time(1_700_000_000, 0), "inputs": tuple(rows)}
    return decode_status(encode_status(nothing._replace(**made)))


def _row(place: int, changes: dict[str, Any]) -> InputStatus:
    row = (
        status_of_nothing()
        .inputs[place]
        ._replace(
            age=AGES[place],
            age_limit=LIMITS[place],
            transport_delay=0.0012,
            accepted=500 + place,
            received=500 + place,
            writer_guid=bytes([place] * 16),
        )
    )
    refused = list(row.refused)
    if changes.get("last_refusal", NO_VALUE) < len(refused):
        refused[changes["last_refusal"]] = 3
    return row._replace(refused=tuple(refused), **changes)


class FakeIsland:
    """Sends a status every 20 ms, and answers requests to arm, until its context ends.

    ``answer`` is asked for a new status when a request came. What it does not model: anything else.
    """

    def __init__(
        self,
        domain_id: int,
        status: Status,
        answer: Callable[[Status], Status] | None = None,
        *,
        listens: bool = True,
    ) -> None:
        self.requests: list[int] = []
        self._said = status
        self._answer = answer
        self._stop = threading.Event()
        self._participant = Participant(domain_id, DdsConfig(interface="lo"), "safety_island")
        make = self._participant
        self._status = make.publisher(STATUS.name, STATUS.type_name, STATUS.qos)
        self._arm = make.subscription(ARM.name, ARM.type_name, ARM.qos) if listens else None
        self._thread = threading.Thread(target=self._run)

    def _run(self) -> None:
        while not self._stop.wait(0.02):
            self._take_request()
            self._said = self._said._replace(tick=self._said.tick + 1)
            self._status.write(encode_status(self._said))

    def _take_request(self) -> None:
        request = self._arm.take_newest() if self._arm else None
        if request is None or self._answer is None:
            return
        nonce = decode_arm(request.data).nonce
        if nonce not in self.requests:
            self.requests.append(nonce)
            self._said = self._answer(self._said)._replace(arm_nonce=nonce)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join()
        self._participant.close()
