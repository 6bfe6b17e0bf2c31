"""Whether a demo went well, each condition with its figures."""

from __future__ import annotations

from typing import NamedTuple

from safety_island.cli.demo.events import DemoState, Event
from safety_island.sim.metrics import (
    MAX_LATERAL_ERROR,
    MAX_STOP_ERROR,
    MIN_SPEED_RATIO,
    SETTLING_S,
)


class Condition(NamedTuple):
    """One thing that must hold."""

    name: str
    holds: bool
    text: str


def conditions(state: DemoState, cut_short: bool = False) -> list[Condition]:
    """Judge a demo that has ended by what its processes reported last.

    ``cut_short``: a person ended it, so a stop that was not reached yet is no failure.
    """
    vehicle = state.vehicle_summary
    if not vehicle:
        return [Condition("drive", False, "the main compute gave no summary")]
    found = [
        _lateral(vehicle),
        _speed(vehicle),
        _stops(vehicle, cut_short),
        _ticks(state.island_summary),
    ]
    can = state.island_summary.get("can_counts")
    return [*found, _frames(can)] if can else found


def _lateral(vehicle: Event) -> Condition:
    text = (
        f"lateral error at most {vehicle['max_lateral_error']:.3f} m after the first"
        f" {SETTLING_S:g} s (limit {MAX_LATERAL_ERROR} m)"
    )
    return Condition("on_course", bool(vehicle["on_course"]), text)


def _speed(vehicle: Event) -> Condition:
    text = (
        f"reached {vehicle['top_speed']:.2f} m/s, asked for {vehicle['top_target']:.2f} m/s"
        f" (limit {MIN_SPEED_RATIO:.0%})"
    )
    return Condition("reached_speed", bool(vehicle["reached_speed"]), text)


def _stops(vehicle: Event, cut_short: bool) -> Condition:
    errors = [abs(error) for error in vehicle["stop_errors"]]
    if not errors:
        return Condition("stopped_in_place", cut_short, "no stop was reached in this time")
    times = "once" if len(errors) == 1 else f"{len(errors)} times"
    text = f"stopped {times}, at most {max(errors):.2f} m from the place"
    text += f" (limit {MAX_STOP_ERROR} m)"
    return Condition("stopped_in_place", bool(vehicle["stopped_in_place"]), text)


def _ticks(island: Event) -> Condition:
    if not island:
        return Condition("no_missed_ticks", False, "the island gave no summary")
    missed, ticks = int(island["missed_ticks"]), int(island["ticks"])
    text = f"{ticks} ticks, {missed or 'none'} missed"
    median_s = island["tick_times_s"]["median"]
    if median_s is not None:
        worst_s = island["tick_times_s"]["max"]
        text += f"; one takes {median_s * 1e3:.2f} ms at the median, {worst_s * 1e3:.2f} ms at most"
    return Condition("no_missed_ticks", missed == 0 and ticks > 0, text)


def _frames(can: Event) -> Condition:
    lost = int(can["failed"]) + int(can["rejected"])
    text = f"{can['sent']} commands went out as three CAN frames, {lost or 'none'} did not"
    return Condition("can_frames", lost == 0 and int(can["sent"]) > 0, text)
