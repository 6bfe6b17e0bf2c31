"""What is allowed can be driven with: the controllers stay finite at both ends of every range."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pytest

from safety_island.control.follower import TrajectoryFollower
from safety_island.control.kernel import prepare
from safety_island.control.params import Parameters
from safety_island.params import ParameterError, from_mapping
from safety_island.params.consistency import TABLES
from safety_island.params.schema import KNOWN, Known
from safety_island.sim.closed_loop import ClosedLoop
from safety_island.sim.courses import load_course

TICKS = 20
NUMBERS = [known for known in KNOWN.values() if known.kind in ("float", "int", "list")]


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
@pytest.mark.parametrize("known", NUMBERS, ids=[known.key for known in NUMBERS])
def test_the_command_stays_finite(known: Known, model: str) -> None:
    prepare()
    for parameters in at_the_ends(known, model):
        period = max(round(parameters.node.ctrl_period / 0.005), 1) * 0.005
        loop = ClosedLoop(TrajectoryFollower(parameters), load_course("s-curve"), period)
        for _ in range(TICKS):
            row = loop.tick()
            assert math.isfinite(row.angle_command) and math.isfinite(row.acceleration_command)
