# SPDX-License-Identifier: Apache-2.0
"""Keys of Autoware's files that have no effect."""

from __future__ import annotations

from pathlib import Path

import pytest

from safety_island.params import load_set, read
from safety_island.params.no_effect import NO_EFFECT
from safety_island.params.scalars import shown
from safety_island.params.schema import KNOWN
from tests.params.files import parameter_file, refused


def test_no_key_is_both_known_and_without_effect() -> None:
    assert not set(NO_EFFECT) & set(KNOWN)


@pytest.mark.parametrize("key", [*NO_EFFECT, "qos_overrides./clock.subscription.depth"])
def test_it_is_accepted_and_told(tmp_path: Path, key: str) -> None:
    reason = NO_EFFECT.get(key)
    value = shown(reason.only) if reason and reason.only is not None else "1.5"
    path = parameter_file(tmp_path, f"{key}: {value}")
    loaded = read([path])
    assert loaded.parameters == load_set("default")
    (ignored,) = loaded.ignored
    assert str(ignored).startswith(f"{path}:3: {key}: no effect: ")


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("use_sim_time: true", "found true (a switch); only false is built in"),
        (
            "use_trajectory_steering_for_feedforward: true",
            "found true (a switch); only false is built in",
        ),
    ],
)
def test_what_would_change_the_controller_is_refused(tmp_path: Path, line: str, told: str) -> None:
    assert told in refused([parameter_file(tmp_path, line)])[0]
