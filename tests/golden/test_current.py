# SPDX-License-Identifier: Apache-2.0
"""Every recorded run of Autoware's newer controllers (0.43 to 0.53) through the real node."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from safety_island.control.release import RELEASES
from safety_island.kernel.kernel import JIT
from safety_island.replay.compare import judge
from safety_island.replay.feed import replay
from safety_island.replay.recording import Recording, find, load
from tests.golden.harness import name_of

DATA = Path(__file__).parent / "current"

pytestmark = pytest.mark.skipif(not JIT, reason="takes minutes in plain Python")

OTHER_RULES = [
    # the run, and the newest release whose rules do not give it any more
    ("manual_mode/r48", "0.47"),
    ("reverse/acc_feedback_r43", "0.46"),
    ("reverse/acc_feedback_r46", "0.45"),
    ("s_curve/offset_r51", "0.50"),
    ("slope/launch053_fast", "0.52"),
    ("slope/raw_pitch_stopped_r51", "0.50"),
    ("slope_goal/goal_adaptive_r43", "0.40"),
    ("slope_reverse/goal_adaptive_r51", "0.53"),
    ("slope_reverse/goal_adaptive_r53", "0.52"),
    ("stop_and_go/launch053_osqp", "0.52"),
    ("stop_release/prev_reset_r43", "0.46"),
    ("stop_release/prev_reset_r46", "0.45"),
    ("stop_short/stopped_margin_r43", "0.40"),
    ("overshoot/emergency_on_r43", "0.40"),
    ("u_turn/window_from_ego_r53", "0.52"),
]


def with_rules(run: Recording, release: str) -> Recording:
    """Return a run to be played by the rules of another release."""
    assert release in RELEASES
    return replace(run, overrides=run.overrides | {"autoware_release": release})


@pytest.mark.parametrize("path", find([DATA]), ids=name_of)
def test_a_run_is_autowares(path: Path) -> None:
    run = load(path)
    verdict = judge(run, replay(run))
    assert verdict.passed, str(verdict.exceeding)
    assert verdict.guard.acts == ()


@pytest.mark.parametrize(("name", "release"), OTHER_RULES)
def test_another_releases_rules_do_not_give_the_run(name: str, release: str) -> None:
    """Each change of the controllers shows in a run: left out, the run fails."""
    run = with_rules(load(DATA / f"{name}.npz"), release)
    if rules_need_another_topic(run, release):
        run = replace(run, steering_offset=None)
    assert not judge(run, replay(run)).passed


def rules_need_another_topic(run: Recording, release: str) -> bool:
    """Whether that release does not subscribe to the offset that the run holds."""
    return run.steering_offset is not None and RELEASES.index(release) < RELEASES.index("0.51")


@pytest.mark.parametrize("name", ["traj_jump/no_deviation_checks_r43"])
def test_the_deviation_checks_can_be_kept(name: str) -> None:
    """They are on in the island's own set: a vehicle far from its trajectory is not driven on."""
    run = load(DATA / f"{name}.npz")
    checked = replace(run, overrides=run.overrides | {"enable_deviation_checks": True})
    assert not judge(checked, replay(checked)).passed
