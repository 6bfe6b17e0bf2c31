# SPDX-License-Identifier: Apache-2.0
"""The figures of the live view as texts, shared by the terminal view and the plain lines."""

from __future__ import annotations

import math

from safety_island.cli.demo.events import DemoState, KeyEvent
from safety_island.words import in_words

UNKNOWN = "-"


def milliseconds(value: float | None) -> str:
    """Return a time [s] in ms."""
    if value is None:
        return UNKNOWN
    return f"{value * 1e3:.2f} ms" if value < 0.01 else f"{value * 1e3:.0f} ms"


def controller(state: DemoState) -> str:
    """Return what the controller does, in a word or two."""
    if not state.tick:
        return "starting"
    if "longitudinal_state" in state.tick:
        failed = state.tick["mpc_status"] != "SOLVED"
        return str(state.tick["longitudinal_state"]) + (
            f", MPC {state.tick['mpc_status']}" if failed else ""
        )
    return in_words(str(state.tick["outcome"]))


def waiting_for(state: DemoState) -> str:
    """Return what the start still waits for."""
    if not state.tick:
        return "the island to start"
    if not state.vehicle:
        return "the main compute to start"
    if state.was_acted_on and state.tick["state"] == "SILENT":
        return "the cause of the silence to go, then key a to arm"
    if state.was_acted_on and state.vehicle["operation_mode"] != "AUTONOMOUS":
        return "key space to engage"
    if state.tick["outcome"] != "PUBLISHED":
        return str(state.tick["detail"]) or str(state.tick["outcome"])
    return "the vehicle to take commands"


def command(state: DemoState) -> str:
    """Return the newest command; nothing when there is none."""
    if "steering_tire_angle" not in state.tick:
        return ""
    angle, acceleration = state.tick["steering_tire_angle"], state.tick["acceleration"]
    return f"{angle:+.3f} rad, {acceleration:+.2f} m/s²"


def island(state: DemoState) -> str:
    """Return the state of the island."""
    return str(state.tick.get("state", UNKNOWN))


def guard(state: DemoState) -> str:
    """Return what the guard did with the newest command, and by which limits."""
    limits = ", ".join(state.tick.get("guard_limits", ()))
    return f"guard {limits or str(state.tick.get('guard') or 'not asked').lower()}"


def target(state: DemoState) -> str:
    """Return where the vehicle has to stop next."""
    stop = state.vehicle.get("stop_station")
    if stop is None:
        return UNKNOWN
    return f"◎ stop in {max(0.0, stop - state.vehicle['station']):.0f} m"


def slope(state: DemoState) -> str:
    """Return the slope of the road at the vehicle."""
    angle = state.vehicle.get("slope")
    return UNKNOWN if angle is None else f"slope {100.0 * math.tan(angle):+.1f} %"


def can_command(state: DemoState) -> str:
    """Return the command that the newest CAN frames carry, decoded; nothing without frames."""
    can = state.tick.get("can") or {}
    if "steering_tire_angle" not in can:
        return str(can.get("fault", ""))
    angle, acceleration = can["steering_tire_angle"]["value"], can["acceleration"]["value"]
    return f"{angle:+.6f} rad, {acceleration:+.3f} m/s²"


def can_number(state: DemoState) -> str:
    """Return the sequence number of the newest CAN frames; nothing without frames."""
    number = (state.tick.get("can") or {}).get("sequence")
    return "" if number is None else f"#{number}"


def event_line(event: KeyEvent) -> str:
    """Return one line about a key, or below it about a reaction."""
    return f"{event.time_s:6.1f} s  {'  ' if event.is_reaction else ''}{event.text}"


def plain_line(state: DemoState) -> str:
    """Return one line about a vehicle that drives."""
    vehicle = state.vehicle
    frames = can_command(state)
    beside = f"  command {command(state)}  CAN {can_number(state)} {frames}" if frames else ""
    return (
        f"{vehicle['time_s']:6.1f} s  {vehicle['station']:6.1f} of {vehicle['length']:.0f} m"
        f"  {vehicle['speed']:5.2f} of {vehicle['target_speed']:5.2f} m/s"
        f"  lateral {vehicle['lateral_error']:+.3f} m  {controller(state)}"
        f"  tick {milliseconds(state.tick.get('tick_s'))}"
        f"  oldest input {milliseconds(state.oldest_input_s)}{beside}"
    )
