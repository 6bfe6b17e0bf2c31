# SPDX-License-Identifier: Apache-2.0
"""Whether a demo went well, each condition with its figures."""

from __future__ import annotations

from typing import NamedTuple

from safety_island.cli.demo.events import DemoState, Event
from safety_island.cli.demo.machine_load import OtherWork
from safety_island.sim.metrics import (
    MAX_LATERAL_ERROR,
    MAX_STOP_ERROR,
    MIN_SPEED_RATIO,
    SETTLING_S,
)


class Condition(NamedTuple):
    """One thing that must hold."""

    name: str
    holds: bool | None
    """None: not judged, because a person disturbed the drive."""
    text: str
    label: str = ""
    """In place of "ok" or "FAILED"."""

    @property
    def verdict(self) -> str:
        """A word for ``holds``."""
        return self.label or {True: "ok", False: "FAILED", None: "-"}[self.holds]


BUSY = "BUSY"
"""Label of what a busy machine can be why of."""

ADVICE = (
    "end what keeps it busy and try again, or allow the island real-time priority"
    " (docs/deploying.md)"
)


def conditions(
    state: DemoState, cut_short: bool = False, others: OtherWork | None = None
) -> list[Condition]:
    """Judge a demo that has ended by what its processes reported last.

    ``cut_short``: a person ended it, so a stop that was not reached yet is no failure; ``others``:
    what else the machine did meanwhile. What a drive did not keep is not judged when a person
    disturbed it by a key.
    """
    vehicle = state.vehicle_summary
    if not vehicle:
        return [Condition("drive", False, "the main compute gave no summary")]
    driven = [_lateral(vehicle), _speed(vehicle), _stops(vehicle, cut_short)]
    if state.was_acted_on:
        driven = [one if one.holds else _not_judged(one) for one in driven]
    elif others is not None and others.is_much and vehicle.get("silences"):
        driven = [one if one.holds else _interrupted(one, vehicle) for one in driven]
    found = [*driven, _ticks(state.island_summary)]
    can = state.island_summary.get("can_counts")
    found = [*found, _frames(can)] if can else found
    return _blamed(found, state.island_summary, others or OtherWork(0.0, 1))


def _blamed(found: list[Condition], island: Event, others: OtherWork) -> list[Condition]:
    """Say once, and say what to do, when a busy machine can be why something was missed."""
    first = next((i for i, one in enumerate(found) if one.label == BUSY), None)
    if not others.is_much:
        return [one._replace(label="") for one in found]
    if first is not None:
        late_s = float(island.get("max_lateness_s") or 0.0)
        why = (
            f"the machine was busy: other programs used {others.cores:.1f} of {others.of} cores,"
            f" and a tick was woken up to {late_s * 1e3:.0f} ms late; {ADVICE}"
        )
        found[first] = found[first]._replace(text=f"{found[first].text}\n{why}")
    return found


def _interrupted(condition: Condition, vehicle: Event) -> Condition:
    times = int(vehicle["silences"])
    text = f"{condition.text}; commands stopped coming {'once' if times == 1 else f'{times} times'}"
    return condition._replace(label=BUSY, text=text)


def _not_judged(condition: Condition) -> Condition:
    return condition._replace(
        holds=None, text=f"{condition.text}; not judged: keys disturbed the drive"
    )


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
    name = "no_missed_ticks"
    if not island:
        return Condition(name, False, "the island gave no summary")
    missed, ticks = int(island["missed_ticks"]), int(island["ticks"])
    text = f"{ticks} ticks, {missed or 'none'} missed"
    median_s = island["tick_times_s"]["median"]
    if median_s is not None:
        worst_s = island["tick_times_s"]["max"]
        text += f"; one takes {median_s * 1e3:.2f} ms at the median, {worst_s * 1e3:.2f} ms at most"
    return Condition(name, missed == 0 and ticks > 0, text, BUSY if missed else "")


def _frames(can: Event) -> Condition:
    lost = int(can["failed"]) + int(can["rejected"])
    text = f"{can['sent']} commands went out as three CAN frames, {lost or 'none'} did not"
    return Condition("can_frames", lost == 0 and int(can["sent"]) > 0, text)
