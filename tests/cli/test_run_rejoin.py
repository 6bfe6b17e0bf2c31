# SPDX-License-Identifier: Apache-2.0
"""When a run ends to join its domain anew, and what the process that follows it keeps."""

from __future__ import annotations

import os
from types import SimpleNamespace
from typing import Any

import pytest

from safety_island.cli import run_rejoin
from safety_island.cli.run_rejoin import IslandRejoin
from safety_island.life_cycle.life_cycle import LifeCycle
from safety_island.life_cycle.reason import Reason
from safety_island.life_cycle.state import State
from safety_island.life_cycle.transition import Life
from safety_island.params import load_set

VARIABLE = "SAFETY_ISLAND_LATCHED"


class Node:
    """What is used of a controller node."""

    def __init__(self) -> None:
        params = load_set("default").life_cycle
        self.life_cycle = LifeCycle(params, 0.15, has_ramp=False)
        self.is_stopped = False

    def stop(self) -> None:
        self.is_stopped = True


@pytest.fixture
def node() -> Any:
    return Node()


@pytest.fixture
def moved(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run_rejoin, "must_rejoin", lambda: True)


def tick(state: State, cause: Reason = Reason.NONE) -> Any:
    return SimpleNamespace(life=Life(state, cause, cause))


@pytest.mark.usefixtures("moved")
@pytest.mark.parametrize("state", State)
def test_a_run_ends_only_while_nothing_is_sent(node: Any, state: State) -> None:
    rejoin = IslandRejoin(node)
    rejoin(tick(state))
    assert rejoin.is_due == node.is_stopped == (state in (State.INIT, State.SILENT))


def test_a_run_goes_on_while_the_address_is_the_same(
    node: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run_rejoin, "must_rejoin", lambda: False)
    rejoin = IslandRejoin(node)
    rejoin(tick(State.INIT))
    assert not rejoin.is_due and not node.is_stopped


@pytest.mark.usefixtures("moved")
def test_an_island_that_was_latched_is_latched_in_the_process_that_follows(
    node: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(VARIABLE, "")
    started: list[str] = []
    monkeypatch.setattr(
        run_rejoin, "start_again", lambda: started.append(os.environ.get(VARIABLE, ""))
    )
    rejoin = IslandRejoin(node)
    assert node.life_cycle.life.state is State.INIT
    rejoin(tick(State.SILENT, Reason.PARTITION))
    rejoin.start_again()
    assert started == [str(int(Reason.PARTITION))]
    IslandRejoin(node)
    assert node.life_cycle.life == Life(State.SILENT, Reason.PARTITION, Reason.PARTITION)
    assert VARIABLE not in os.environ, "a process that this one starts is another island"


@pytest.mark.usefixtures("moved")
def test_an_island_that_was_not_latched_begins_as_every_other(
    node: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    started: list[bool] = []
    monkeypatch.setattr(run_rejoin, "start_again", lambda: started.append(VARIABLE in os.environ))
    rejoin = IslandRejoin(node)
    rejoin(tick(State.INIT, Reason.NONE))
    rejoin.start_again()
    assert started == [False]
