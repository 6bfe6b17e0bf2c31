# SPDX-License-Identifier: Apache-2.0
"""What keys and buttons do to the drive, and the reactions that are seen."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Protocol

from safety_island.cli.demo.child import Child
from safety_island.cli.demo.events import ARM, BRIDGE, SECOND_ISLAND, VEHICLE, DemoState
from safety_island.control.status import Mode
from safety_island.life_cycle.reason import Reason
from safety_island.node.explain import explain
from safety_island.node.inputs import INPUTS
from safety_island.params import IslandParameters
from safety_island.sim.console import FREEZABLE, JUMP_M

HELP: Mapping[str, str] = {
    " ": "disengage/engage",
    "k": "kill the bridge",
    "n": "NaN odometry",
    "f": "freeze a topic",
    "2": "second island",
    "a": "arm",
    "q": "end",
}
"""Every key and what it does; the fault keys clear their fault when they are pressed again."""

MODE, KILL, NAN, JUMP, SECOND = "mode", "kill bridge", "nan", "jump", "second island"
FREEZE, STILL, CLEAR, ARM_AGAIN = "freeze", "still", "clear", "arm"
"""Names of the page's buttons, or their first word."""
HEALS = (CLEAR, ARM_AGAIN)
BUTTONS: Mapping[str, str] = {
    NAN: "NaN odometry",
    JUMP: "Trajectory jumps",
    **{f"{FREEZE} {topic}": f"Freeze {topic}" for topic in FREEZABLE},
    KILL: "Kill the bridge",
    f"{STILL} {BRIDGE}": "Bridge hangs",
    f"{STILL} {VEHICLE}": "Main compute hangs",
    SECOND: "Second island",
    MODE: "Disengage/engage",
    CLEAR: "Clear all faults",
    ARM_AGAIN: "Arm the island",
}
"""Every button of the page and what is written on it; a fault's second press clears it."""

JITTER_S = 0.08
"""What a bound allows for wake-ups and transport [s], as the catalogue of faults does."""

WATCHED_S = 30.0
"""Changes this long after a key [s] are shown as reactions to it."""


class Processes(Protocol):
    """What the keys need of a session."""

    state: DemoState

    def find(self, name: str) -> Child | None:
        """Return a running child of that name."""

    def add(self, child: Child) -> None:
        """Start a child."""

    def drop(self, child: Child, *, kill: bool = False) -> None:
        """End a child whose end is no failure of the demo."""

    def end(self) -> None:
        """End the demo in order."""

    def lift_limit(self) -> None:
        """Let the drive take as long as it needs: a person acts on it."""


@dataclass(frozen=True)
class Recipes:
    """Makes the processes that a key starts, not started."""

    bridge: Callable[[], Child]
    second_island: Callable[[], Child]
    arm: Callable[[], Child]


class Actions:
    """Obeys keys and buttons; every one is an event line of the state."""

    def __init__(self, processes: Processes, recipes: Recipes) -> None:
        self._processes, self._recipes = processes, recipes
        self._state = processes.state
        self._is_nan = self._has_jumped = False
        self._frozen: list[str] = []
        self._still: list[str] = []
        self._next_topic = 0
        self._has_faults = False
        self._acts: dict[str, Callable[[], str]] = {
            MODE: self._engage,
            KILL: self._bridge,
            NAN: self._nan,
            JUMP: self._jump,
            SECOND: self._second,
            ARM_AGAIN: self._arm,
            CLEAR: self._clear,
            **{f"{FREEZE} {topic}": partial(self._freeze, topic) for topic in FREEZABLE},
            **{f"{STILL} {name}": partial(self._stand_still, name) for name in (BRIDGE, VEHICLE)},
        }
        self._keys = {
            " ": self._engage,
            "k": self._bridge,
            "n": self._nan,
            "f": self._freeze_next,
            "2": self._second,
            "a": self._arm,
            "q": self._end,
        }

    def press(self, key: str) -> bool:
        """Obey a key; return whether it is one."""
        act = self._keys.get(key)
        if act is None:
            return False
        shown = "space" if key == " " else key
        self._state.add_event(f"key {shown}: {act()}")
        return True

    def click(self, name: str) -> bool:
        """Obey a button of the page; return whether it is one."""
        act = self._acts.get(name)
        if act is None:
            return False
        self._state.add_event(f"page: {act()}")
        return True

    def buttons(self) -> list[dict[str, object]]:
        """Return the buttons of the page, each with whether what it causes lasts."""
        lasting = {
            KILL: self._has_faults and self._processes.find(BRIDGE) is None,
            NAN: self._is_nan,
            JUMP: self._has_jumped,
            SECOND: self._processes.find(SECOND_ISLAND) is not None,
            **{f"{FREEZE} {topic}": True for topic in self._frozen},
            **{f"{STILL} {name}": True for name in self._still},
        }
        return [
            {"key": key, "label": label, "active": lasting.get(key, False), "clears": key in HEALS}
            for key, label in BUTTONS.items()
        ]

    def _engage(self) -> str:
        self._begin_fault()  # how the drive goes from here on is a person's doing
        if self._state.vehicle.get("operation_mode") == Mode.AUTONOMOUS.name:
            self._vehicle("disengage")
            return "autonomous mode disengaged"
        self._vehicle("engage")
        return "autonomous mode engaged"

    def _bridge(self) -> str:
        self._begin_fault()
        bridge = self._processes.find(BRIDGE)
        if bridge is None:
            self._processes.add(self._recipes.bridge())
            return "bridge started anew"
        if BRIDGE in self._still:
            self._still.remove(BRIDGE)
        self._processes.drop(bridge, kill=True)
        return "bridge killed"

    def _stand_still(self, name: str) -> str:
        self._begin_fault()
        child = self._processes.find(name)
        if child is None:
            return f"{name} does not run"
        if name in self._still:
            self._still.remove(name)
            child.go_on()
            return f"{name} goes on"
        self._still.append(name)
        child.stand_still()
        return f"{name} stands still"

    def _nan(self) -> str:
        self._begin_fault()
        self._is_nan = not self._is_nan
        self._vehicle("nan" if self._is_nan else "number")
        return "odometry is NaN" if self._is_nan else "odometry is a number again"

    def _jump(self) -> str:
        self._begin_fault()
        self._has_jumped = not self._has_jumped
        self._vehicle("jump" if self._has_jumped else "return")
        to = f"{JUMP_M:g} m to the left" if self._has_jumped else "back to its place"
        return f"trajectory jumps {to}"

    def _freeze_next(self) -> str:
        """Freeze one topic after the other; each is thawed before the next."""
        if self._frozen:
            return self._freeze(self._frozen[-1])
        topic = FREEZABLE[self._next_topic]
        self._next_topic = (self._next_topic + 1) % len(FREEZABLE)
        return self._freeze(topic)

    def _freeze(self, topic: str) -> str:
        self._begin_fault()
        if topic in self._frozen:
            self._frozen.remove(topic)
            self._vehicle(f"thaw {topic}")
            return f"{topic} is published again"
        self._frozen.append(topic)
        self._vehicle(f"freeze {topic}")
        return f"{topic} is frozen: published no more"

    def _second(self) -> str:
        self._begin_fault()
        second = self._processes.find(SECOND_ISLAND)
        if second is None:
            self._processes.add(self._recipes.second_island())
            return "second island started"
        self._processes.drop(second)
        return "second island ended"

    def _clear(self) -> str:
        """Take every fault away; what it caused is left to the island and to whoever arms it."""
        cleared = [self._acts[str(b["key"])]() for b in self.buttons() if b["active"]]
        return "; ".join(cleared) or "there is no fault to clear"

    def _arm(self) -> str:
        if self._processes.find(ARM) is None:
            self._processes.add(self._recipes.arm())
        return "the island is asked to arm"

    def _end(self) -> str:
        self._processes.end()
        return "end"

    def _begin_fault(self) -> None:
        """From now on the mode stays AUTONOMOUS, as Autoware's does: the island shows its latch."""
        if not self._has_faults:
            self._has_faults = self._state.was_acted_on = True
            self._vehicle("stay")
            self._processes.lift_limit()

    def _vehicle(self, line: str) -> None:
        vehicle = self._processes.find(VEHICLE)
        if vehicle is not None:
            vehicle.say(line)


class Reactions:
    """Turns changes of island and vehicle after a key into event lines; told the time [s]."""

    def __init__(self, state: DemoState, parameters: IslandParameters) -> None:
        gate = parameters.gate
        self._state = state
        self._limits_s = {spec.name: spec.age_limit_s(gate) for spec in INPUTS}
        self._margin_s = parameters.node.ctrl_period + JITTER_S
        self._pressed_at = -math.inf
        self._seen = self._now_seen()

    def pressed(self, now: float) -> None:
        """A key acts at ``now``."""
        self._pressed_at = now
        self._seen = self._now_seen()

    def look(self, now: float) -> None:
        """Compare with what was seen before."""
        before, self._seen = self._seen, self._now_seen()
        since = now - self._pressed_at
        if since > WATCHED_S:
            return
        if self._seen[0] != before[0] and self._seen[0] is not None:
            self._state.add_event(self._island(since), is_reaction=True)
        if self._seen[1] != before[1] and self._seen[1] is not None:
            text = f"vehicle {self._seen[1]} after {since:.2f} s"
            self._state.add_event(text, is_reaction=True)

    def _now_seen(self) -> tuple[str | None, str | None]:
        return self._state.tick.get("state"), self._state.vehicle.get("gate")

    def _island(self, since: float) -> str:
        tick = self._state.tick
        reason, subject = Reason[tick["reason"]], tick.get("subject")
        text = f"island {tick['state']} after {since:.2f} s"
        bound = self._bound_s(reason, subject)
        if bound is not None and tick["state"] == "SILENT":
            text += f", bound {bound:.2f} s"
        if reason is Reason.NONE:
            return text
        names = [spec.name for spec in INPUTS]
        place = names.index(subject) if subject in names else len(names)
        return f"{text}: {explain(reason, place)}"

    def _bound_s(self, reason: Reason, subject: str | None) -> float | None:
        """Time [s] within which an input that is lost must silence the island, where known."""
        if reason is Reason.INPUT_STALE and subject in self._limits_s:
            return self._limits_s[subject] + self._margin_s
        if reason is Reason.PARTITION:  # the first input that became too old did it
            return min(self._limits_s.values()) + self._margin_s
        return None
