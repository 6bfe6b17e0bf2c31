# SPDX-License-Identifier: Apache-2.0
"""The vehicle on its course behind a command gate, driven by commands as they come."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from typing import Any

from safety_island.control.status import Mode
from safety_island.sim.closed_loop import orientation
from safety_island.sim.courses import Course
from safety_island.sim.gate import CommandGate, GateState
from safety_island.sim.metrics import Metrics
from safety_island.sim.planner import Planner
from safety_island.sim.plant import STEP_S, Plant

MOST_STEPS = 40
"""Steps that are made up for after a delay; beyond that the world stood still with its process."""

SETTLE_S = 1.0
"""Time [s] for which the vehicle is still shown at its last stop."""


Pose = tuple[float, float, float, float, float, float, float]
"""x, y, z [m] and a quaternion x, y, z, w."""


class World:
    """Plant, gate, planner and metrics in step with a clock; times in s, monotonic.

    Drives ``laps`` laps, or with ``repeat`` laps without end.
    Starts in STOP mode and engages AUTONOMOUS, when ``engage`` is on, as soon as commands come;
    leaves it again, when ``leave`` is on, when they stop coming.
    """

    def __init__(
        self,
        course: Course,
        start: float,
        *,
        repeat: bool = False,
        laps: int = 1,
        engage: bool = True,
        leave: bool = True,
        say: Callable[[str], None] = lambda _: None,
    ) -> None:
        self.course, self.gate = course, CommandGate()
        self.planner = Planner(course, repeat=repeat or laps > 1)
        x, y, yaw = self.planner.start_pose()
        self.plant = Plant(x=x, y=y, yaw=yaw)
        self.metrics = Metrics(stop_errors=self.planner.stop_errors)
        self.mode = Mode.STOP
        self.stood_still_s = 0.0
        self._engage, self._leave, self._say = engage, leave, say
        self._last_lap = None if repeat else laps - 1
        self._time = start
        self._finished_at: float | None = None

    def offer_command(self, now: float, angle: float, acceleration: float) -> None:
        """Take a command [rad, m/s^2] that came at ``now``; the first one may engage."""
        self.advance(now)
        self.gate.offer(now, angle, acceleration)
        if self._engage and self.mode is Mode.STOP:
            self._set_mode(Mode.AUTONOMOUS)
            self._say("commands come: autonomous mode engaged")

    def engage(self) -> None:
        """Engage autonomous mode with the next command, at once when commands come."""
        self._engage = True

    def disengage(self) -> None:
        """Leave autonomous mode, and stay so although commands come."""
        self._engage = False
        self._set_mode(Mode.STOP)

    def stay_engaged(self) -> None:
        """Stay in autonomous mode when commands stop coming, as Autoware does."""
        self._leave = False

    def _set_mode(self, mode: Mode) -> None:
        self.mode, self.gate.engaged = mode, mode is Mode.AUTONOMOUS

    def advance(self, now: float) -> None:
        """Move the vehicle on to ``now``, in whole steps."""
        due = int((now - self._time) / STEP_S + 1e-6)
        if due > MOST_STEPS:
            self.stood_still_s += (due - MOST_STEPS) * STEP_S
            self._time += (due - MOST_STEPS) * STEP_S
            due = MOST_STEPS
        if due <= 0:
            return
        before = self.gate.state
        self.plant.command(*self.gate.output(now, self.plant.speed))
        self._tell_gate(before)
        self.plant.advance(due, self.planner.place.pitch)
        self._time += due * STEP_S
        self._judge(now)

    def _judge(self, now: float) -> None:
        """Find the vehicle on the course; measure while it drives on its own."""
        made = len(self.planner.stop_errors)
        place = self.planner.update(now, self.plant.x, self.plant.y, self.plant.speed)
        if self.mode is Mode.AUTONOMOUS:
            self.metrics.update(now, place, self.plant.speed)
        if self.planner.lap == self._last_lap:
            self.planner.repeat = False
        if len(self.planner.stop_errors) > made:
            error = self.planner.stop_errors[-1]
            side = "beyond" if error >= 0.0 else "before"
            self._say(f"stopped {abs(error):.2f} m {side} {self.planner.stop_station:.1f} m")
        if self.planner.finished and self._finished_at is None:
            self._finished_at = now

    def _tell_gate(self, before: GateState) -> None:
        if self.gate.state is before:
            return
        if self.gate.state is GateState.BRAKING:
            if self.mode is Mode.AUTONOMOUS:  # in manual mode nobody waits for them
                self._say("commands stopped coming: braking")
            if self._leave:
                self._set_mode(Mode.STOP)
        elif before is GateState.BRAKING:
            self._say("commands are back")

    def has_ended(self, now: float) -> bool:
        """Whether the course was driven and the vehicle has stood at its end for SETTLE_S."""
        return self._finished_at is not None and now - self._finished_at >= SETTLE_S

    def pose(self) -> Pose:
        """Position [m] and orientation on the road."""
        place, plant = self.planner.place, self.plant
        return plant.x, plant.y, place.height, *orientation(plant.yaw, place.pitch)

    def status(self, now: float) -> dict[str, Any]:
        """What a viewer wants to know; lengths in m, speeds in m/s, angles in rad, times in s."""
        place, plant, metrics = self.planner.place, self.plant, self.metrics
        return {
            "time_s": 0.0 if metrics.started is None else now - metrics.started,
            "station": place.station,
            "length": self.course.length,
            "lap": self.planner.lap,
            "stop_station": self.planner.stop_station,
            "x": plant.x,
            "y": plant.y,
            "yaw": plant.yaw,
            "speed": plant.speed,
            "target_speed": place.speed,
            "acceleration": plant.acceleration,
            "steering": plant.steering,
            "lateral_error": place.lateral_error,
            "slope": place.pitch,
            "max_lateral_error": metrics.max_lateral_error,
            "gate": self.gate.state.value,
            "operation_mode": self.mode.name,
            "command_age_s": self.gate.silence(now),
            "commands": self.gate.received,
        }

    def summary(self) -> dict[str, Any]:
        """How the drive went: the metrics, their verdicts, and what disturbed it."""
        metrics = self.metrics
        return {
            **asdict(metrics),
            "on_course": metrics.on_course,
            "reached_speed": metrics.reached_speed,
            "stopped_in_place": metrics.stopped_in_place,
            "finished": self._finished_at is not None,
            "laps": self.planner.lap,
            "commands": self.gate.received,
            "silences": self.gate.silences,
            "stood_still_s": self.stood_still_s,
        }
