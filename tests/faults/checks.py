# SPDX-License-Identifier: Apache-2.0
"""What a scene must show: bounds on virtual time, and the way back."""

from __future__ import annotations

import pytest

from safety_island.input_gate.warning import InputWarning
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.node.report import TickReport
from tests.faults.scene import FAST, INPUTS, SLOW, Row, Scene

EPSILON_S = 1e-6
BOTH = pytest.mark.parametrize("period_s", [SLOW, FAST])
JITTER_S = 0.02
LIMIT_S = {"trajectory": 0.9, "odometry": 0.5, "steering": 0.5, "acceleration": 0.5}


def bound(key: str, period_s: float) -> float:
    """Age limit, one period, jitter: 0.67 s at 150 ms and 0.55 s at 30 ms for the fast inputs."""
    return LIMIT_S[key] + period_s + JITTER_S


def silent_within(scene: Scene, since: float, bound_s: float, margin_s: float = 1.0) -> Row:
    """Run on; nothing may leave the island later than ``bound_s`` [s] after ``since``, for good.

    Returns the first silent tick.
    """
    scene.run(since + bound_s + margin_s - scene.now)
    after = [row for row in scene.rows if row.at > since]
    late = [row for row in after if row.output != "silent" and row.at > since + bound_s + EPSILON_S]
    assert not late, f"output {late[0].at - since:.3f} s after the fault: {late[0]}"
    assert scene.rows[-1].output == "silent", scene.rows[-1]
    return next(row for row in after if row.output == "silent")


def stays_active(scene: Scene, seconds: float) -> list[Row]:
    """Run on; every tick must publish and stay ACTIVE. Returns the ticks."""
    rows = scene.run(seconds)
    bad = [row for row in rows if row.state is not State.ACTIVE or row.output != "published"]
    assert rows and not bad, bad[0]
    return rows


def stays_latched(scene: Scene, cause: Reason, seconds: float = 1.0) -> None:
    """Run on with the fault gone: the island must stay silent and say that it waits."""
    rows = scene.run(seconds)
    assert {row.state for row in rows} == {State.SILENT}
    assert {row.output for row in rows} == {"silent"}
    assert rows[-1].reason in (Reason.LATCHED, cause)
    assert scene.node.life_cycle.life.cause is cause


def rearms(scene: Scene, within_s: float = 1.0) -> None:
    """Leave autonomous mode and engage again: READY, then ACTIVE, and it drives on."""
    scene.disengage()
    rows = scene.run(within_s)
    states = [row.state for row in rows]
    assert State.READY in states, states
    assert states[-1] is State.ACTIVE, (states, rows[-1].reason)
    stays_active(scene, 1.0)


def recovers(scene: Scene, cause: Reason, settle_s: float = 1.0) -> None:
    """Clear the fault: the silence is latched, re-arming ends it."""
    scene.clear()
    scene.run(settle_s)
    stays_latched(scene, cause)
    rearms(scene)


def warned(scene: Scene) -> dict[str, InputWarning]:
    """Return what is warned of each input in any tick from now on; it fills as the scene runs."""
    found = dict.fromkeys(INPUTS, InputWarning(0))

    def note(report: TickReport) -> None:
        for key, bits in zip(INPUTS, scene.node.inputs.warnings, strict=True):
            found[key] |= bits

    scene.node.observers.append(note)
    return found


def subject(row: Row) -> str:
    """Return the key of the input that a tick's reason is about."""
    return INPUTS[row.subject]
