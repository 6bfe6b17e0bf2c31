# SPDX-License-Identifier: Apache-2.0
"""What is allowed can be driven with: the controllers stay finite at both ends of every range."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pytest

from safety_island.control.follower import TrajectoryFollower
from safety_island.control.params import Parameters
from safety_island.core.guard import Guard, Proposal
from safety_island.kernel.kernel import prepare
from safety_island.params import ParameterError, from_mapping
from safety_island.params.consistency import TABLES
from safety_island.params.schema import KNOWN, Known, values_of
from safety_island.sim.closed_loop import ClosedLoop
from safety_island.sim.courses import load_course
from tests.params.files import OWN_KEYS

TICKS = 20
NUMBERS = [known for known in KNOWN.values() if known.kind in ("float", "int", "list")]
THEIRS = [known for known in NUMBERS if known.key not in OWN_KEYS]
OURS = [known for known in NUMBERS if known.key in OWN_KEYS]
GUARD = [known for known in OURS if known.group == "guard"]


def at_the_ends(known: Known, model: str) -> Iterator[Parameters]:
    """Both ends of a range over the default set, where they fit the other values."""
    for end in (known.low, known.high):
        overrides: dict[str, object] = {known.key: int(end) if known.kind == "int" else end}
        if known.kind == "list":
            table = next(pair for pair in TABLES if known.key in pair)
            overrides = {key: [end if key == known.key else 1.0] for key in table}
        try:
            yield from_mapping({**overrides, "vehicle_model_type": model})
        except ParameterError:
            continue


@pytest.mark.parametrize("model", KNOWN["vehicle_model_type"].choices)
@pytest.mark.parametrize("known", THEIRS, ids=[known.key for known in THEIRS])
def test_the_command_stays_finite(known: Known, model: str) -> None:
    prepare()
    for parameters in at_the_ends(known, model):
        period = max(round(parameters.node.ctrl_period / 0.005), 1) * 0.005
        loop = ClosedLoop(TrajectoryFollower(parameters), load_course("s-curve"), period)
        for _ in range(TICKS):
            row = loop.tick()
            assert math.isfinite(row.angle_command) and math.isfinite(row.acceleration_command)


def own_end(known: Known, end: float) -> dict[str, object]:
    """One end of an own range, with lists of one entry so that they fit each other."""
    lists = {other.key: [1.0] for other in OURS if other.kind == "list"}
    value: object = int(end) if known.kind == "int" else end
    return {**lists, known.key: [value]} if known.kind == "list" else {known.key: value}


@pytest.mark.parametrize("known", OURS, ids=[known.key for known in OURS])
def test_our_own_keys_take_both_ends(known: Known) -> None:
    """Each end is taken as it stands, or refused for another key that it must fit."""
    for end in (known.low, known.high):
        try:
            found = values_of(from_mapping(own_end(known, end)))[known.key]
        except ParameterError as error:
            assert known.key in {"guard.shortest_step", "guard.longest_step"}, error
        else:
            assert found == ((end,) if known.kind == "list" else end)


@pytest.mark.parametrize("known", GUARD, ids=[known.key for known in GUARD])
def test_the_guard_stays_finite(known: Known) -> None:
    for end in (known.low, known.high):
        try:
            limits = from_mapping(own_end(known, end)).guard
        except ParameterError:
            continue
        guard = Guard(limits, 2.74, 0.5)
        for i in range(TICKS):
            proposal = Proposal(i * 0.1, i * 0.1, i, 9.0 * (-1) ** i, -9.0, 99.0, 9.0 * (-1) ** i)
            assert all(map(math.isfinite, guard.check(proposal, float(i), 0.1)))
