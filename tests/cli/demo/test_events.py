# SPDX-License-Identifier: Apache-2.0
"""The demo's state follows what its processes report."""

from __future__ import annotations

from safety_island.cli.demo.events import BRIDGE, ISLAND, VEHICLE, DemoState
from tests.cli.demo.samples import ISLAND_SUMMARY, STATUS, TICK, VEHICLE_SUMMARY, WAITING


def test_newest_of_everything_is_kept() -> None:
    state = DemoState()
    for source, event in (
        (ISLAND, WAITING),
        (ISLAND, TICK),
        (ISLAND, {"event": "first_control", "after_s": 1.5}),
        (ISLAND, ISLAND_SUMMARY),
        (VEHICLE, STATUS),
        (VEHICLE, VEHICLE_SUMMARY),
        (BRIDGE, {"event": "counts", "forwarded": 12}),
    ):
        state.update(source, event)
    assert state.tick is TICK
    assert state.first_control_s == 1.5
    assert state.island_summary is ISLAND_SUMMARY
    assert state.vehicle is STATUS
    assert state.vehicle_summary is VEHICLE_SUMMARY
    assert state.forwarded == 12
    assert state.is_driving


def test_unknown_events_are_passed_over() -> None:
    state = DemoState()
    for source in (ISLAND, VEHICLE, BRIDGE):
        state.update(source, {"event": "of a later version"})
    assert state == DemoState()


def test_oldest_input_leaves_out_what_is_sent_on_change() -> None:
    assert DemoState(tick=TICK).oldest_input_s == 0.06


def test_oldest_input_is_unknown_until_all_came() -> None:
    assert DemoState().oldest_input_s is None
    assert DemoState(tick=WAITING).oldest_input_s is None
