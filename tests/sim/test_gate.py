# SPDX-License-Identifier: Apache-2.0
"""The command gate: every state, and what it does to the vehicle."""

from __future__ import annotations

import pytest

from safety_island.sim.gate import BRAKE, HOLD, CommandGate, GateState, next_state


@pytest.mark.parametrize(
    ("silence", "engaged", "state"),
    [
        (None, False, GateState.WAITING),
        (None, True, GateState.WAITING),
        (0.0, False, GateState.READY),
        (0.5, False, GateState.READY),
        (0.51, False, GateState.BRAKING),
        (0.0, True, GateState.DRIVING),
        (0.5, True, GateState.DRIVING),
        (0.51, True, GateState.BRAKING),
    ],
)
def test_states(silence: float | None, engaged: bool, state: GateState) -> None:
    assert next_state(silence, engaged, 0.5) is state


def test_passes_the_newest_command_when_engaged() -> None:
    gate = CommandGate()
    gate.offer(10.0, 0.1, 0.5)
    gate.offer(10.1, 0.2, 0.6)
    assert gate.output(10.2, 5.0) == (0.0 + 0.2, BRAKE)
    gate.engaged = True
    assert gate.output(10.2, 5.0) == (0.2, 0.6)
    assert gate.received == 2


def test_brakes_in_silence_and_recovers() -> None:
    gate = CommandGate()
    gate.engaged = True
    gate.offer(10.0, 0.1, 0.5)
    assert gate.output(10.5, 5.0) == (0.1, 0.5)
    assert gate.output(10.6, 5.0) == (0.1, BRAKE)
    assert gate.output(10.7, 0.0) == (0.1, HOLD)
    assert (gate.state, gate.silences) == (GateState.BRAKING, 1)
    gate.offer(11.0, 0.3, 0.7)
    assert gate.output(11.0, 0.0) == (0.3, 0.7)
    assert gate.state is GateState.DRIVING
